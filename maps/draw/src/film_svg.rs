//! The film as an animated SVG (SMIL): a few dozen kilobytes that a browser plays at any size.

use socrates_model::{EventKind, Gesture};

use crate::actor::{RING, moment};
use crate::film::{Film, Panel};
use crate::film_cards::{draw_end, draw_title};
use crate::label::text_width;
use crate::map_layer::draw_floor;
use crate::marks::body;
use crate::palette;
use crate::presence::There;
use crate::svg::Svg;

/// Samples of a way per second of the film; between them it goes straight.
const HZ: f64 = 6.0;

impl Film<'_> {
    /// The film as SVG that plays by itself, again and again.
    #[must_use]
    pub fn animated_svg(&self) -> String {
        let (w, h) = (f64::from(self.options.size.0), f64::from(self.options.size.1));
        let mut svg = Svg::new(w, h);
        svg.rect((0.0, 0.0), (w, h), "fill=\"#ffffff\"");
        for (index, panel) in self.panels.iter().enumerate() {
            svg.raw(&format!("<clipPath id=\"panel-{index}\">"));
            let (at, size) = ((panel.view.x, panel.view.y), (panel.view.w, panel.view.h));
            svg.rect(at, size, "");
            svg.raw(&format!("</clipPath><g clip-path=\"url(#panel-{index})\">"));
            svg.rect(at, size, &format!("fill=\"{}\"", palette::UNKNOWN));
            self.follow(&mut svg, panel);
            draw_floor(&mut svg, panel.location, &panel.camera.world());
            self.animate_doors(&mut svg, panel);
            self.animate_agents(&mut svg, panel);
            svg.raw("</g></g>");
            if self.options.labels {
                self.animate_words(&mut svg, panel);
            }
        }
        if self.options.labels {
            let (length, (title_s, end_s)) = (self.times.length_s(), self.times.cards_s);
            svg.raw(&format!("<g opacity=\"0\">{}", self.shown_in_film(&[(0.0, title_s)])));
            draw_title(&mut svg, self);
            svg.raw(&format!("</g><g opacity=\"0\">{}", self.shown_in_film(&[(length - end_s, length)])));
            self.panels.iter().for_each(|panel| draw_end(&mut svg, panel));
            svg.raw("</g>");
        }
        svg.finish()
    }

    /// Opens the group in which everything lies where it is on the map, and which moves as the camera goes.
    fn follow(&self, svg: &mut Svg, panel: &Panel<'_>) {
        let at = |now: f64| panel.camera.frame(now).at;
        let (x, y) = at(self.times.from_s);
        svg.raw(&format!("<g transform=\"translate({x:.1},{y:.1})\">"));
        if !panel.camera.is_still() {
            let way: Vec<String> = self.samples().into_iter().map(at).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
            svg.raw(&format!(
                "<animateTransform attributeName=\"transform\" type=\"translate\" class=\"camera\" values=\"{}\" {}/>",
                way.join(";"),
                self.timing()
            ));
        }
    }

    /// Moments of the run at even steps of the film.
    fn samples(&self) -> Vec<f64> {
        let length = self.times.length_s();
        let count = (length * HZ).ceil().max(1.0);
        let mut moments = Vec::new();
        let mut step = 0.0;
        while step <= count {
            moments.push(self.times.at_film_s(length * step / count));
            step += 1.0;
        }
        moments
    }

    fn timing(&self) -> String {
        format!("dur=\"{:.2}s\" repeatCount=\"indefinite\"", self.times.length_s())
    }

    /// Shows what is drawn so far in a group only within stretches of the run, s.
    fn shown_within(&self, stretches: &[(f64, f64)]) -> String {
        let film: Vec<(f64, f64)> =
            stretches.iter().map(|(from, to)| (self.times.film_s(*from), self.times.film_s(*to))).collect();
        self.shown_in_film(&film)
    }

    /// The same within stretches of the film, s.
    fn shown_in_film(&self, stretches: &[(f64, f64)]) -> String {
        let length = self.times.length_s();
        let (mut values, mut times) = (vec!["0"], vec![0.0]);
        for (from, to) in stretches {
            let (from, to) = (from / length, to / length);
            if to <= from {
                continue;
            }
            if from <= 1e-9 {
                values = vec!["1"];
            } else {
                values.push("1");
                times.push(from);
            }
            if to < 1.0 - 1e-9 {
                values.push("0");
                times.push(to);
            }
        }
        let times: Vec<String> = times.iter().map(|t| format!("{t:.4}")).collect();
        format!(
            "<animate attributeName=\"opacity\" calcMode=\"discrete\" values=\"{}\" keyTimes=\"{}\" {}/>",
            values.join(";"),
            times.join(";"),
            self.timing()
        )
    }

    fn animate_agents(&self, svg: &mut Svg, panel: &Panel<'_>) {
        let moments = self.samples();
        let agents: Vec<_> = panel.recording.header.agents.iter().enumerate().collect();
        for (place, info) in agents.iter().rev() {
            let color = palette::agent(info.agent.number());
            let mut spots: Vec<(f64, f64)> = Vec::new();
            let mut turns: Vec<f64> = Vec::new();
            let there = There::of(panel.recording);
            let state_at = |now: f64| moment(panel.recording, now).get(*place).filter(|state| there.is(state));
            // Before it comes somebody waits, unseen, where it will be.
            let coming = moments.iter().find_map(|now| state_at(*now));
            for now in &moments {
                let state = state_at(*now).or(if spots.is_empty() { coming } else { None });
                let spot = state.map(|state| panel.camera.world().px(panel.location, &state.point()));
                let turn = state.map(|state| -state.yaw.to_degrees());
                let before = (spots.last().copied(), turns.last().copied());
                let Some(spot) = spot.or(before.0) else { continue };
                let last = before.1.unwrap_or(0.0);
                let turn = turn.unwrap_or(last);
                spots.push(spot);
                // The short way round.
                turns.push(last + (turn - last) - 360.0 * ((turn - last) / 360.0).round());
            }
            let (Some(first), Some(turn)) = (spots.first().copied(), turns.first().copied()) else { continue };
            let seen = presence(&moments, |now| state_at(now).is_some());
            if let Some(seen) = &seen {
                svg.raw(&format!("<g opacity=\"0\">{}", self.shown_within(seen)));
            }
            self.animate_trail(svg, &spots, color);
            let r = panel.look.radius_px(info.radius_m);
            let list: Vec<String> = spots.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
            let angles: Vec<String> = turns.iter().map(|turn| format!("{turn:.0}")).collect();
            let timing = self.timing();
            svg.raw(&format!(
                "<g transform=\"translate({:.1},{:.1})\"><animateTransform attributeName=\"transform\" type=\"translate\" values=\"{}\" {timing}/>",
                first.0, first.1, list.join(";")
            ));
            svg.raw(&format!(
                "<g transform=\"rotate({turn:.0})\"><animateTransform attributeName=\"transform\" type=\"rotate\" values=\"{}\" {timing}/>{}</g>",
                angles.join(";"),
                body(info.agent.number() == 0, r, color)
            ));
            let size = panel.look.text_px * 0.95;
            if panel.look.named(info.agent.number()) {
                let name = info.agent.to_string().replace("human_", "h");
                // Below whoever comes so near to the upper edge that its name would be cut.
                let seen_at = spots.iter().zip(&moments).map(|((_, y), now)| y + panel.camera.frame(*now).at.1);
                let highest = seen_at.fold(f64::INFINITY, f64::min);
                let cut = highest - r - size * 1.4 < panel.view.y;
                svg.label(
                    (0.0, if cut { r + size * 1.05 } else { -r - size * 0.35 }),
                    &name,
                    size,
                    palette::agent_words(info.agent.number()),
                );
            }
            self.animate_gestures(svg, panel, *place, r, size);
            svg.raw("</g>");
            if seen.is_some() {
                svg.raw("</g>");
            }
        }
    }

    /// A line that grows with the way.
    fn animate_trail(&self, svg: &mut Svg, spots: &[(f64, f64)], color: &str) {
        let mut gone = vec![0.0];
        for (a, b) in spots.iter().zip(spots.iter().skip(1)) {
            gone.push(gone.last().copied().unwrap_or(0.0) + (b.0 - a.0).hypot(b.1 - a.1));
        }
        let whole = gone.last().copied().unwrap_or(0.0);
        if whole < 1.0 {
            return;
        }
        let left: Vec<String> = gone.iter().map(|done| format!("{:.3}", 1.0 - done / whole)).collect();
        let points: Vec<String> = spots.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        svg.raw(&format!(
            "<polyline points=\"{}\" pathLength=\"1\" stroke-dasharray=\"1 2\" stroke-dashoffset=\"1\" fill=\"none\" stroke=\"{color}\" \
             stroke-width=\"3\" stroke-opacity=\"0.45\" stroke-linejoin=\"round\"><animate attributeName=\"stroke-dashoffset\" values=\"{}\" {}/></polyline>",
            points.join(" "),
            left.join(";"),
            self.timing()
        ));
    }

    fn animate_gestures(&self, svg: &mut Svg, panel: &Panel<'_>, place: usize, r: f64, size: f64) {
        let mut stretches: Vec<(Gesture, f64, f64)> = Vec::new();
        let step = panel.recording.header.step_s;
        let mut now_s = 0.0;
        for tick in 0..panel.recording.ticks() {
            let said = panel.recording.tick(tick).get(place).and_then(socrates_model::AgentState::gesture);
            match stretches.last_mut() {
                Some((gesture, _, to)) if Some(*gesture) == said && (now_s - *to) < step * 1.5 => *to = now_s,
                _ => stretches.extend(said.map(|gesture| (gesture, now_s, now_s + step))),
            }
            now_s += step;
        }
        for gesture in Gesture::ALL {
            let when: Vec<(f64, f64)> =
                stretches.iter().filter(|(said, _, _)| *said == gesture).map(|(_, from, to)| (*from, *to)).collect();
            if when.is_empty() {
                continue;
            }
            let words = gesture.name().replace('_', " ");
            let wide = text_width(&words, size) + size * 0.9;
            svg.raw(&format!("<g opacity=\"0\">{}", self.shown_within(&when)));
            svg.circle((0.0, 0.0), r * RING, "fill=\"none\" stroke=\"#e69f00\" stroke-width=\"3\"");
            svg.rect(
                (-wide / 2.0, r * RING + 4.0),
                (wide, size * 1.4),
                &format!("rx=\"{:.1}\" fill=\"#fff4d6\" stroke=\"#b07a00\" stroke-width=\"1.5\"", size * 0.3),
            );
            svg.text(
                (0.0, r * RING + 4.0 + size * 1.05),
                &words,
                &format!(
                    "font-size=\"{size:.1}\" font-weight=\"700\" text-anchor=\"middle\" fill=\"{}\"",
                    palette::INK
                ),
            );
            svg.raw("</g>");
        }
    }

    fn animate_doors(&self, svg: &mut Svg, panel: &Panel<'_>) {
        for door in &panel.location.doors {
            let mut open: Vec<(f64, f64)> = Vec::new();
            let mut since: Option<f64> = None;
            for event in &panel.recording.events {
                let EventKind::Door { door: id, open: is } = &event.kind else { continue };
                if *id != door.id {
                    continue;
                }
                match (since, is) {
                    (None, true) => since = Some(event.time.secs()),
                    (Some(from), false) => {
                        open.push((from, event.time.secs()));
                        since = None;
                    }
                    (None, false) | (Some(_), true) => {}
                }
            }
            open.extend(since.map(|from| (from, f64::MAX)));
            let mut shut = Vec::new();
            let mut free = 0.0;
            for (from, to) in &open {
                shut.push((free, *from));
                free = *to;
            }
            shut.push((free, f64::MAX));
            let frame = panel.camera.world();
            let (from, to) = (frame.px(panel.location, &door.from), frame.px(panel.location, &door.to));
            let width = frame.len(panel.location, 0.14).max(3.0);
            for (part, when) in [(0.14, open), (0.5, shut)] {
                let (dx, dy) = ((to.0 - from.0) * part, (to.1 - from.1) * part);
                svg.raw(&format!("<g opacity=\"0\">{}", self.shown_within(&when)));
                let style = format!("stroke=\"{}\" stroke-width=\"{width:.1}\"", palette::DOOR);
                svg.line(from, (from.0 + dx, from.1 + dy), &style);
                svg.line(to, (to.0 - dx, to.1 - dy), &style);
                svg.raw("</g>");
            }
        }
    }

    /// The run's name, a clock that counts whole seconds, and captions.
    fn animate_words(&self, svg: &mut Svg, panel: &Panel<'_>) {
        let size = panel.look.text_px;
        let at = panel.clock_at();
        svg.heading(at, &panel.title, size, palette::INK);
        let clock = at.0 + text_width(&panel.title, size) + size * 2.5;
        let mut second = self.times.from_s.floor();
        while second <= self.times.to_s {
            svg.raw(&format!("<g opacity=\"0\">{}", self.shown_within(&[(second, second + 1.0)])));
            svg.text(
                (clock, at.1),
                &format!("{second:.0} s"),
                &format!("font-size=\"{size:.1}\" text-anchor=\"end\" fill=\"{}\"", palette::INK),
            );
            svg.raw("</g>");
            second += 1.0;
        }
        // The rows change where a caption comes or goes.
        let secs = self.caption_s();
        let mut changes: Vec<f64> = panel.captions.iter().flat_map(|(t, _)| [*t, t + secs]).collect();
        changes.sort_by(f64::total_cmp);
        for (from, to) in changes.iter().zip(changes.iter().skip(1)).filter(|(from, to)| to > from) {
            for (row, words) in panel.told(f64::midpoint(*from, *to), secs).enumerate() {
                svg.raw(&format!("<g opacity=\"0\">{}", self.shown_within(&[(*from, *to)])));
                panel.draw_caption(svg, row, &words);
                svg.raw("</g>");
            }
        }
    }
}

/// From when to when somebody is there, s; `None` for one who always is. What begins or ends with the film is open.
fn presence(moments: &[f64], there: impl Fn(f64) -> bool) -> Option<Vec<(f64, f64)>> {
    let mut spans: Vec<(f64, f64)> = Vec::new();
    let mut since: Option<f64> = None;
    for (index, now) in moments.iter().enumerate() {
        match (there(*now), since) {
            (true, None) => since = Some(if index == 0 { f64::NEG_INFINITY } else { *now }),
            (false, Some(from)) => {
                spans.push((from, *now));
                since = None;
            }
            (true, Some(_)) | (false, None) => {}
        }
    }
    spans.extend(since.map(|from| (from, f64::INFINITY)));
    let always = spans.iter().any(|(from, to)| from.is_infinite() && to.is_infinite());
    (!always).then_some(spans)
}

#[cfg(test)]
mod tests {
    use crate::film::{Film, FilmOptions, Shown};
    use crate::fixture::{hall, walk};

    #[test]
    fn an_animated_film_plays_everybody_and_loads_nothing() {
        let (location, run) = (hall("hall"), walk(3));
        let film = |labels: bool| {
            let options = FilmOptions { size: (640, 360), labels, ..FilmOptions::USUAL };
            let shown = [Shown { recording: &run, report: None, name: None }];
            Film::new(&location, "they meet", &[&run], &shown, options).unwrap().animated_svg()
        };
        let svg = film(true);
        assert_eq!(svg.matches("type=\"translate\"").count(), 4);
        assert!(svg.contains(">h3<") && svg.contains("reference") && svg.contains(">5 s<"));
        assert!(!film(false).contains("reference") && !film(false).contains(">h3<"));
        assert!(!svg.replace("http://www.w3.org/2000/svg", "").contains("://") && !svg.contains("<script"));
        assert_eq!(svg, film(true));
        // Somebody who comes later is hidden until then.
        let late = crate::fixture::away(walk(3), 2, 0..300);
        let options = FilmOptions { size: (640, 360), labels: true, ..FilmOptions::USUAL };
        let shown = [Shown { recording: &late, report: None, name: None }];
        let shown = Film::new(&location, "they meet", &[&late], &shown, options).unwrap().animated_svg();
        assert_eq!(shown.matches("<g opacity=\"0\">").count(), svg.matches("<g opacity=\"0\">").count() + 1);
        assert!(shown.contains("values=\"0;1\""));
        // It is a drawing too: what does not play it shows its beginning.
        crate::png::png_from_svg(&svg, 1.0).unwrap();
    }
}
