//! Clauses in the order in which they are read: manners behind who they are of, names beside names.

use crate::cut::{Joint, Stretch};
use crate::lexicon::lexicon;
use crate::mention::{Who, mentions};
use crate::negation::denied;
use crate::words::Word;

/// The clauses in the order in which they are read: what stands before who does it comes after, and names go together.
pub(crate) fn arranged(mut found: Vec<Stretch>) -> Vec<Stretch> {
    if let Some(first) = found.first_mut() {
        asked(first);
    }
    found.iter_mut().for_each(bidden);
    // `A patient, not a visitor, comes out`
    found.retain(|stretch| {
        !(stretch.joint == Joint::Comma
            && stretch.words.first().is_some_and(|word| word.text == "not")
            && matches!(mentions(stretch.words.get(1..).unwrap_or_default()).as_slice(), [only] if only.from == 0 && only.to + 2 == stretch.words.len()))
    });
    of_them(&mut found);
    excepting(&mut found);
    denied(&mut found);
    spoken_first(&mut found);
    out_of(&mut found);
    headed(&mut found);
    measured(&mut found);
    bracketed(&mut found);
    pair(&mut found);
    resumed(&mut found);
    parted(&mut found);
    fronted(apposed(found))
}

/// `Everybody except the nurse stops`, `Except for the first, they stop`: the exception stands behind what it is one to.
fn excepting(found: &mut Vec<Stretch>) {
    let Some(at) = found.iter().position(|stretch| stretch.joint == Joint::Except) else { return };
    let Some(exception) = found.get(at) else { return };
    let end = mentions(&exception.words).first().filter(|mention| mention.from == 0).map(|mention| mention.to);
    let Some(end) = end else { return };
    let verb = |word: &Word| lexicon().verbs.contains(&word.stem);
    let acts = exception.words.get(end + 1).is_some_and(verb);
    let idle = |stretch: &Stretch| stretch.words.len() <= 4 && !stretch.words.iter().any(verb);
    if acts && at > 0 && found.get(at - 1).is_some_and(idle) {
        let rest = found.get_mut(at).map(|exception| exception.words.split_off(end + 1)).unwrap_or_default();
        if let Some(all) = found.get_mut(at - 1) {
            all.words.extend(rest);
        }
    } else if at == 0 && exception.words.len() == end + 1 && found.len() > 1 {
        found.swap(0, 1);
        if let [all, exception, ..] = found.as_mut_slice() {
            (all.joint, exception.joint) = (Joint::Opens, Joint::Except);
        }
    }
}

/// `of the two who remain, one makes room`: one of them.
fn of_them(found: &mut [Stretch]) {
    let text = |stretch: &Stretch, k: usize| stretch.words.get(k).map(|word| word.text.clone()).unwrap_or_default();
    let whole = found.iter().position(|stretch| {
        text(stretch, 0) == "of"
            && matches!(text(stretch, 1).as_str(), "the" | "these" | "those")
            && stretch.words.get(2).is_some_and(|word| word.count().is_some_and(|n| n > 1))
    });
    let Some(whole) = whole else { return };
    for stretch in found.iter_mut().skip(whole + 1) {
        let at = usize::from(matches!(text(stretch, 0).as_str(), "only" | "just" | "exactly"));
        let Some(one) = stretch.words.get(at).filter(|word| word.count().is_some() && !word.is_digits()).cloned()
        else {
            continue;
        };
        // `one of them`, `one nurse` say it themselves.
        if stretch.words.get(at + 1).is_some_and(|next| lexicon().verbs.contains(&next.stem)) {
            let word = |text: &str| Word { text: text.to_owned(), stem: text.to_owned(), used: true, ..one.clone() };
            stretch.words.splice(at + 1..at + 1, [word("of"), word("them")]);
            return;
        }
    }
}

/// `Asked by the robot to wait, the packer stops`: when the robot asks.
fn asked(first: &mut Stretch) {
    let asks = first.words.first().is_some_and(|word| {
        matches!(word.stem.as_str(), "ask" | "tell" | "signal" | "request" | "order" | "instruct" | "urge" | "invite")
            && word.text != word.stem
    });
    let by = first.words.get(1).is_some_and(|word| word.text == "by");
    let robot = (2..5).find(|k| first.words.get(*k).is_some_and(|word| word.stem == "robot"));
    if let Some(robot) = robot.filter(|_| asks && by) {
        let mut agent: Vec<Word> = first.words.drain(1..=robot).collect();
        agent.remove(0);
        first.words.splice(0..0, agent);
        first.joint = Joint::When;
    }
}

/// `steps aside when asked`, `only once told to wait`: the robot does.
fn bidden(stretch: &mut Stretch) {
    let temporal = matches!(stretch.joint, Joint::When | Joint::Until);
    let Some(first) = stretch.words.first().filter(|_| temporal).cloned() else { return };
    let asks =
        matches!(first.stem.as_str(), "ask" | "tell" | "request" | "order" | "instruct") && first.text != first.stem;
    let next = stretch.words.get(1).map_or("", |word| word.text.as_str());
    // `makes room upon request`
    if first.text == "request" && stretch.words.len() == 1 {
        let robot = Word { text: "robot".to_owned(), stem: "robot".to_owned(), used: true, ..first.clone() };
        let asks = Word { text: "asks".to_owned(), stem: "ask".to_owned(), ..first };
        stretch.words = vec![robot, asks];
        return;
    }
    let often = matches!(next, "again" | "once" | "twice" | "a")
        || stretch.words.get(1).is_some_and(|word| word.count().is_some());
    if asks && (often || matches!(next, "" | "to" | "politely" | "nicely" | "kindly" | "so")) {
        let robot = Word { text: "robot".to_owned(), stem: "robot".to_owned(), used: true, ..first };
        stretch.words.insert(0, Word { to: robot.from, ..robot });
    }
}

/// `Anna and Ben, two interns, stand there`, `Ana and Bruno, both of them consultants, …`: so many, who have names.
fn pair(found: &mut Vec<Stretch>) {
    let lex = lexicon();
    let last_name = |stretch: &Stretch| stretch.words.last().is_some_and(|word| word.name);
    for at in 1..found.len() {
        let names = found.get(at - 1).is_some_and(last_name)
            && found.get(at).is_some_and(|ben| ben.joint == Joint::And && ben.words.len() == 1 && last_name(ben));
        let both = |words: &[Word]| {
            let skip = match words.first().map(|word| word.text.as_str()) {
                Some("both") if words.get(1).is_some_and(|word| word.text == "of") => 3,
                Some("both" | "two") => 1,
                _ => return None,
            };
            let role = words.iter().skip(skip).any(|word| lex.roles.contains_key(&word.stem));
            (role && words.len() <= skip + 3).then_some(skip)
        };
        let Some(skip) = found.get(at + 1).filter(|_| names).and_then(|also| both(&also.words)) else { continue };
        let (Some(rest), true) = (found.get(at + 2).cloned(), found.len() > at + 2) else { continue };
        let mut noun = found.remove(at + 1).words;
        let from = noun.first().cloned();
        noun.drain(0..skip);
        let second: Vec<Word> = found.drain(at..=at + 1).take(1).flat_map(|name| name.words).collect();
        if let (Some(head), Some(word)) = (found.get_mut(at - 1), from) {
            head.also.extend(head.words.pop());
            head.also.extend(second);
            head.words.push(Word { text: "two".to_owned(), stem: "two".to_owned(), ..word });
            head.words.extend(noun);
            head.words.extend(rest.words);
        }
        return;
    }
}

/// `Neither of the two visitors who come towards the robot gives way`: what they do stands behind who they are.
fn resumed(found: &mut Vec<Stretch>) {
    for at in 1..found.len() {
        let verbless = |head: &Stretch| {
            !head
                .words
                .iter()
                .any(|word| lexicon().verbs.contains(&word.stem) && !lexicon().roles.contains_key(&word.stem))
                && matches!(mentions(&head.words).as_slice(), [only] if only.to + 1 == head.words.len())
        };
        let head = found.get(at - 1).filter(|head| {
            head.words.first().is_some_and(|word| matches!(word.text.as_str(), "neither" | "none" | "each" | "nobody"))
                || head.words.first().is_some_and(|word| matches!(word.text.as_str(), "the" | "after" | "then" | "at"))
                    && verbless(head)
        });
        let Some(who) = found.get(at).filter(|who| who.joint == Joint::Who && head.is_some()) else { continue };
        let verb = |word: &Word| {
            word.text != word.stem
                && word.text.ends_with('s')
                && lexicon().verbs.contains(&word.stem)
                && !lexicon().things.contains(&word.text)
        };
        let first = who
            .words
            .iter()
            .position(|word| lexicon().verbs.contains(&word.stem) || lexicon().known.contains(&word.stem));
        // A verb behind `and`, `it` or `to` is no second one.
        let free = |k: usize| {
            !who.words.get(k - 1).is_some_and(|word| {
                matches!(word.text.as_str(), "to" | "the" | "its" | "his" | "her" | "a" | "that" | "and" | "or" | "it")
            })
        };
        let again = (first.unwrap_or(0) + 2..who.words.len()).find(|k| who.words.get(*k).is_some_and(verb) && free(*k));
        let Some((again, head)) = again.zip(head.cloned()) else { continue };
        if let Some(who) = found.get_mut(at) {
            let rest = who.words.split_off(again);
            let mut words = head.words;
            words.extend(rest);
            found.insert(at + 1, Stretch { joint: Joint::Comma, after_and: false, words, also: Vec::new() });
        }
        return;
    }
}

/// `"Follow me", the robot signals to a visitor`: what is said stands behind who says it.
fn spoken_first(found: &mut Vec<Stretch>) {
    let says = |word: &Word| matches!(word.stem.as_str(), "say" | "signal" | "tell" | "ask" | "call" | "gesture");
    let robot = |stretch: &Stretch| {
        stretch.words.iter().take(2).any(|word| word.stem == "robot") && stretch.words.iter().take(4).any(says)
    };
    let message = |stretch: &Stretch| {
        stretch.words.len() <= 3
            && lexicon().gestures.iter().any(|phrase| {
                crate::words::find(&stretch.words, phrase, 0, false, &|_| true)
                    .is_some_and(|at| at.first() == Some(&0) && at.last() == Some(&(stretch.words.len() - 1)))
            })
    };
    let first = found.first().is_some_and(message)
        && found.get(1).is_some_and(|next| next.joint == Joint::Comma && robot(next));
    if first {
        let message = found.remove(0);
        if let Some(says) = found.first_mut() {
            says.joint = message.joint;
            says.words.extend(message.words);
        }
    }
}

/// `Out of the break room, on its left, comes a mechanic`: what comes stands behind where it comes from.
fn out_of(found: &mut Vec<Stretch>) {
    let starts = found.first().is_some_and(|first| {
        matches!(first.words.as_slice(), [out, of, ..] if out.text == "out" && of.text == "of")
            && mentions(&first.words).is_empty()
    });
    let comes = |stretch: &Stretch| {
        stretch.joint == Joint::Comma
            && stretch
                .words
                .first()
                .is_some_and(|word| matches!(word.stem.as_str(), "come" | "step" | "walk" | "emerge" | "run"))
    };
    let at = (1..found.len().min(4)).find(|k| found.get(*k).is_some_and(comes));
    if let Some(at) = at.filter(|_| starts) {
        let comes = found.remove(at);
        if let Some(first) = found.first_mut() {
            first.words.extend(comes.words);
        }
    }
}

/// `when his foreman, who comes up behind it, says "go ahead"`: of the verb of a clause, and the relative clause behind it.
fn headed(found: &mut Vec<Stretch>) {
    for at in 0..found.len() {
        let head = found.get(at).is_some_and(|head| {
            matches!(head.joint, Joint::When | Joint::While | Joint::Until | Joint::Except)
                && matches!(mentions(&head.words).as_slice(), [only] if only.from == 0 && only.to + 1 == head.words.len())
        });
        let relative = found.get(at + 1).is_some_and(|who| who.joint == Joint::Who);
        let verb = found.get(at + 2).is_some_and(|verb| {
            verb.joint == Joint::Comma
                && verb.words.first().is_some_and(|word| {
                    let plural = found.get(at).is_some_and(|head| head.joint == Joint::Except);
                    lexicon().verbs.contains(&word.stem)
                        && (plural && word.text == word.stem || word.text != word.stem && word.text.ends_with('s'))
                })
        });
        if head && relative && verb {
            let rest = found.remove(at + 2);
            if let Some(head) = found.get_mut(at) {
                head.words.extend(rest.words);
            }
        }
    }
}

/// `when it is close (1 m)`: a measure alone belongs to the clause before it.
fn measured(found: &mut Vec<Stretch>) {
    let unit = |word: &Word| matches!(word.stem.as_str(), "meter" | "centimeter" | "second");
    let number = |word: &Word| word.is_digits() || word.count().is_some();
    let about = |word: &Word| {
        matches!(
            word.text.as_str(),
            "about"
                | "approx"
                | "roughly"
                | "ca"
                | "around"
                | "circa"
                | "for"
                | "away"
                | "at"
                | "within"
                | "from"
                | "distance"
                | "of"
                | "a"
                | "already"
                | "only"
                | "namely"
        )
    };
    for at in (1..found.len()).rev() {
        let alone = found.get(at).is_some_and(|measure| {
            measure.joint == Joint::Comma
                && measure.words.len() <= 6
                && measure.words.iter().any(unit)
                && measure.words.iter().any(number)
                && measure.words.iter().all(|word| unit(word) || number(word) || about(word))
        });
        let free = found.get(at - 1).is_some_and(|before| {
            !before.words.iter().any(unit) && before.words.iter().any(|word| lexicon().verbs.contains(&word.stem))
        });
        // `and, at a distance of 2.5 m, moves out of its way`: of what comes then.
        let fronted = found.get(at).is_some_and(|measure| {
            measure
                .words
                .first()
                .is_some_and(|word| matches!(word.text.as_str(), "at" | "within" | "from" | "already" | "only"))
        }) && found.get(at + 1).is_some_and(|next| {
            next.joint == Joint::Comma && next.words.first().is_some_and(|word| lexicon().verbs.contains(&word.stem))
        });
        if alone && free && !fronted {
            let measure = found.remove(at);
            if let Some(before) = found.get_mut(at - 1) {
                before.words.extend(measure.words);
            }
        }
    }
}

/// `only the first gives way (robot within 2 m)`: a measure of the robot in brackets says when.
fn bracketed(found: &mut [Stretch]) {
    for at in 1..found.len() {
        let acts = found
            .get(at - 1)
            .is_some_and(|before| before.words.iter().any(|word| lexicon().verbs.contains(&word.stem)));
        let Some(measure) = found.get_mut(at).filter(|measure| acts && measure.joint == Joint::Comma) else { continue };
        let word = |k: usize| measure.words.get(k);
        let robot = word(0).is_some_and(|word| word.stem == "robot")
            || word(1).is_some_and(|word| word.stem == "robot") && word(0).is_some_and(|word| word.text == "the");
        let unit = measure.words.iter().any(|word| matches!(word.stem.as_str(), "meter" | "centimeter"));
        let verb = measure
            .words
            .iter()
            .any(|word| lexicon().verbs.contains(&word.stem) && !matches!(word.stem.as_str(), "be" | "close" | "near"));
        if robot && unit && !verb && measure.words.len() <= 8 {
            measure.joint = Joint::When;
        }
    }
}

/// `the robot asks two loaders, who stand in its way, to make room`: what is asked goes with who asks.
fn parted(found: &mut Vec<Stretch>) {
    asked_of(found);
    for at in 2..found.len() {
        let rest = found.get(at).is_some_and(|rest| {
            rest.joint == Joint::Comma
                && rest.words.first().is_some_and(|word| word.text == "to")
                && rest.words.get(1).is_some_and(|word| lexicon().known.contains(&word.stem))
        });
        let between = |who: &Stretch| matches!(who.joint, Joint::Who | Joint::When);
        let Some(who) = (1..at).rev().find(|k| found.get(*k).is_some_and(between)) else {
            continue;
        };
        let asks = found.get(who - 1).is_some_and(|asks| asks.words.iter().any(asks_for));
        if rest && asks {
            let rest = found.remove(at);
            if let Some(asks) = found.get_mut(who - 1) {
                asks.words.extend(rest.words);
            }
            return;
        }
    }
}

/// Verbs by which somebody wants something of somebody else.
fn asks_for(word: &Word) -> bool {
    matches!(
        word.stem.as_str(),
        "ask" | "tell" | "signal" | "order" | "request" | "beckon" | "instruct" | "motion" | "gesture"
    )
}

/// `it signals a picker who comes from the right to go first`: what is asked stands behind whom it is asked of.
fn asked_of(found: &mut [Stretch]) {
    for at in 1..found.len() {
        let verb = |word: &Word| lexicon().verbs.contains(&word.stem) || lexicon().known.contains(&word.stem);
        let open = found.get(at - 1).is_some_and(|asks| {
            let asked = asks.words.iter().position(asks_for);
            asked.is_some_and(|asked| {
                // Nothing is asked for as yet.
                !asks.words.iter().skip(asked).any(|word| matches!(word.text.as_str(), "to" | "for" | "that"))
                    && mentions(&asks.words).last().is_some_and(|last| last.to + 1 == asks.words.len())
            })
        });
        let Some(who) = found.get(at).filter(|who| open && who.joint == Joint::Who) else { continue };
        let to = (2..who.words.len()).rev().find(|k| {
            who.words.get(*k).is_some_and(|word| word.text == "to")
                && who.words.get(k + 1).is_some_and(|word| verb(word) && word.text == word.stem)
                && !who.words.get(k - 1).is_some_and(|word| {
                    matches!(
                        word.stem.as_str(),
                        "want" | "try" | "wish" | "need" | "like" | "refuse" | "close" | "next"
                    )
                })
        });
        let Some(to) = to else { continue };
        let rest = found.get_mut(at).map(|who| who.words.split_off(to)).unwrap_or_default();
        if let Some(asks) = found.get_mut(at - 1) {
            asks.words.extend(rest);
        }
    }
}

/// `Walking ahead of the robot, a couple …`: a manner before who it is of is read after it.
fn fronted(mut found: Vec<Stretch>) -> Vec<Stretch> {
    let names = |stretch: &Stretch| !mentions(&stretch.words).is_empty();
    let Some(first) = found.iter().position(names) else { return found };
    let mut manners = Vec::new();
    let mut at = 0;
    for _ in 0..first {
        let manner = found
            .get(at)
            .is_some_and(|stretch| matches!(stretch.joint, Joint::Opens | Joint::Comma) && is_manner(&stretch.words));
        if manner {
            manners.push(found.remove(at));
        } else {
            at += 1;
        }
    }
    if found.get(at).is_none_or(|stretch| !matches!(stretch.joint, Joint::Comma | Joint::Opens)) {
        // Nobody to whom it could belong.
        found.splice(0..0, manners);
        return found;
    }
    for (k, mut manner) in manners.into_iter().enumerate() {
        manner.joint = Joint::Comma;
        found.insert(at + 1 + k, manner);
    }
    found
}

/// Whether words only say how or where: a participle, or a place beside the robot.
fn is_manner(words: &[Word]) -> bool {
    let text = |k: usize| words.get(k).map_or("", |word| word.text.as_str());
    let lex = lexicon();
    let robot = words.iter().any(|word| word.stem == "robot");
    match words.first() {
        Some(first) if first.text.ends_with("ing") => lex.verbs.contains(&first.stem),
        Some(first) if text(1) == "by" && first.text.ends_with("ed") => robot,
        Some(_) => {
            text(0) == "from" && matches!(text(1), "behind" | "the") && words.iter().all(|word| word.text != "to")
                || matches!(text(0), "beside" | "alongside" | "behind" | "ahead" | "next" | "in")
                    && robot
                    && words.len() <= 5
                || matches!(text(0), "side" | "arm" | "hand") && words.len() <= 4
        }
        None => false,
    }
}

/// `the cleaner, a shy man, stands`, `Ahmed, a clerk, waits`: one clause about one person.
fn apposed(mut found: Vec<Stretch>) -> Vec<Stretch> {
    counted(&mut found);
    let mut at = 0;
    while at + 1 < found.len() {
        // `Lena, who is a lawyer, …`
        let named = found.get(at).zip(found.get(at + 1)).is_some_and(|(name, who)| {
            is_name(name)
                && who.joint == Joint::Who
                && who.words.first().is_some_and(|word| word.stem == "be")
                && mentions(&who.words).first().is_some_and(|mention| mention.from == 1)
        });
        if named {
            let mut who = found.remove(at + 1);
            who.words.remove(0);
            if let Some(name) = found.get_mut(at) {
                name.also = std::mem::replace(&mut name.words, who.words);
            }
        }
        if let (Some(name), Some(other)) = (found.get(at), found.get(at + 1))
            && let Some(also) = apposition(name, other, found.get(at + 2))
        {
            let rest = if found.len() > at + 2 { Some(found.remove(at + 2)) } else { None };
            let other = found.remove(at + 1);
            if let Some(name) = found.get_mut(at) {
                match also {
                    Also::Second => name.also = other.words,
                    Also::First => name.also = std::mem::replace(&mut name.words, other.words),
                }
                name.words.extend(rest.into_iter().flat_map(|rest| rest.words));
            }
        }
        at += 1;
    }
    found
}

/// `people, maybe four, stand there`: the number belongs to the people.
fn counted(found: &mut Vec<Stretch>) {
    for at in 1..found.len() {
        let (Some(name), Some(number)) = (found.get(at - 1), found.get(at)) else { return };
        let role = name.words.len() <= 2
            && name
                .words
                .last()
                .is_some_and(|word| lexicon().roles.contains_key(&word.stem) && crate::noun::plural(word))
            && name.words.iter().all(|word| word.count().is_none());
        let guess = |word: &Word| {
            matches!(
                word.text.as_str(),
                "maybe" | "perhaps" | "about" | "say" | "roughly" | "around" | "probably" | "exactly"
            )
        };
        let alone = number.joint == Joint::Comma
            && number.words.iter().all(|word| word.count().is_some() || guess(word))
            && number.words.iter().any(|word| word.count().is_some());
        if role && alone && found.len() > at + 1 {
            let mut number = found.remove(at);
            let rest = found.remove(at);
            if let Some(name) = found.get_mut(at - 1) {
                let noun = name.words.len().saturating_sub(1);
                number.words.retain(|word| word.count().is_some());
                name.words.splice(noun..noun, number.words);
                name.words.extend(rest.words);
            }
            return;
        }
    }
}

/// Whether a clause is nothing but a name that no table has.
fn is_name(name: &Stretch) -> bool {
    let lex = lexicon();
    matches!(name.words.as_slice(), [only] if only.capital && !lex.known.contains(&only.stem) && !lex.stop.contains(&only.text))
}

/// Which of two names is the one that stays.
enum Also {
    First,
    Second,
}

fn apposition(name: &Stretch, other: &Stretch, next: Option<&Stretch>) -> Option<Also> {
    let lex = lexicon();
    let whole = |words: &[Word]| {
        let found = mentions(words);
        matches!(found.as_slice(), [only] if only.from == 0 && (only.to + 1 == words.len() || words.get(only.to + 1).is_some_and(|word| matches!(word.text.as_str(), "on" | "in" | "from" | "with" | "of" | "at"))))
    };
    let goes_on = |next: &Stretch| {
        let verb = next
            .words
            .iter()
            .take(2)
            .any(|word| lex.verbs.contains(&word.stem) || matches!(word.text.as_str(), "not" | "never" | "just"));
        let names = mentions(&next.words).first().is_some_and(|mention| mention.from == 0);
        next.joint == Joint::Comma && verb && !names
    };
    // `one of them, the first one, says`
    let told = other.words.first().is_some_and(|word| word.text == "the")
        && matches!(mentions(&other.words).as_slice(), [only] if matches!(only.who, Who::Ordinal(_) | Who::ToldApart) && only.to + 1 == other.words.len());
    if told && other.joint == Joint::Comma && whole(&name.words) && next.is_some_and(goes_on) {
        return Some(Also::First);
    }
    let numbered = matches!(mentions(&name.words).as_slice(), [only] if matches!(only.who, Who::Number(_)) && only.to + 1 == name.words.len());
    if numbered && other.joint == Joint::Comma && other.words.len() == 1 && whole(&other.words) {
        return Some(Also::Second);
    }
    let article =
        other.words.first().is_some_and(|word| matches!(word.text.as_str(), "a" | "an" | "her" | "his" | "their"));
    let bare = other.words.len() == 1 && whole(&other.words);
    if other.joint != Joint::Comma || !(article && whole(&other.words) || bare) {
        return None;
    }
    let called = is_name(name);
    let single = name
        .words
        .first()
        .is_some_and(|word| !matches!(word.text.as_str(), "two" | "three" | "four" | "several" | "both"));
    match next {
        Some(next) if !goes_on(next) => None,
        Some(_) if called && article => Some(Also::First),
        Some(_) | None if single && whole(&name.words) && (next.is_some() || bare) => Some(Also::Second),
        Some(_) | None => None,
    }
}
