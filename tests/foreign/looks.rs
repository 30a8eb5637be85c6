//! What pages, pictures and films look like: words that can be read, people that can be seen, nothing cut off.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use socrates_tests::browser;

use crate::{WAREHOUSE, make, socrates};

/// The demo's request: a door, people on both sides of it, and gestures.
const DEMO: &str = "elevator";

fn shipped(location: &str, stem: &str) -> String {
    let requests = socrates_maps::shipped::requests(location);
    requests.iter().find(|(name, _)| *name == stem).map(|(_, text)| (*text).to_owned()).unwrap()
}

fn bundle(folder: &Path, name: &str, request: &str) -> PathBuf {
    let (finished, _) = make(folder, name, request, &["--require", "any"]);
    assert!(matches!(finished.code, 0 | 3), "{}", finished.err);
    folder.join(format!("bundle-{name}"))
}

fn number(count: usize) -> f64 {
    f64::from(u32::try_from(count).unwrap())
}

/// What the probe of a report page finds: overflow, heights of neighbors, names on walls and on each other, and the curve.
const REPORT: &str = r##"
  const box = (node) => { const b = node.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; };
  const shared = (a, b) => Math.max(0, Math.min(a[0] + a[2], b[0] + b[2]) - Math.max(a[0], b[0])) * Math.max(0, Math.min(a[1] + a[3], b[1] + b[3]) - Math.max(a[1], b[1]));
  const map = document.getElementById("map"), frame = box(map), toScreen = map.getScreenCTM();
  const wall = [...document.querySelectorAll("#floor-0 path")].find((p) => p.getAttribute("fill") === "#3b3f46");
  const walls = [...wall.getAttribute("d").matchAll(/M([-\d.]+) ([-\d.]+)h([-\d.]+)v([-\d.]+)/g)].map((m) => m.slice(1, 5).map(Number))
    .map(([x, y, w, h]) => [x * toScreen.a + toScreen.e, y * toScreen.d + toScreen.f, w * toScreen.a, h * toScreen.d]);
  const slider = document.getElementById("time"), end = Number(slider.max), names = [];
  for (let t = 0; t <= end; t += 0.5) {
    slider.value = t; slider.dispatchEvent(new Event("input"));
    const now = [...map.querySelectorAll("text")].filter((n) => /^(robot|h\d+)$/.test(n.textContent) && n.parentNode.getAttribute("visibility") !== "hidden").map(box);
    now.forEach((a, i) => names.push({ t, dark: walls.reduce((sum, w) => sum + shared(a, w), 0) / (a[2] * a[3]),
      on: now.reduce((most, b, j) => j === i ? most : Math.max(most, shared(a, b) / (a[2] * a[3])), 0),
      out: 1 - shared(a, frame) / (a[2] * a[3]) }));
  }
  const rows = new Map();
  for (const s of document.querySelectorAll(".columns > section")) { const b = s.getBoundingClientRect(); const y = Math.round(b.top); rows.set(y, [...(rows.get(y) || []), b.height]); }
  const heads = [...document.querySelectorAll("h2")].map((h) => h.firstChild.textContent.trim());
  const plot = document.querySelector("#plots .plot"), curve = [...plot.querySelectorAll("path")].filter((p) => p.getAttribute("stroke") === "#0072b2").pop();
  return { names, rows: [...rows.values()], heads, wide: document.documentElement.scrollWidth, width: innerWidth,
    points: (curve.getAttribute("d").match(/[ML]/g) || []).length, bend: plot.querySelectorAll(".bend").length,
    title: plot.querySelector("p").textContent, signs: (document.querySelector("main").textContent.match(/`/g) || []).length,
    codes: document.querySelectorAll("main code").length };
"##;

#[test]
fn a_report_page_can_be_read_on_a_desk_and_on_a_phone() {
    let Some(chromium) = browser::chromium() else { return };
    let folder = tempfile::tempdir().unwrap();
    for (name, request) in [("door", shipped("hospital", DEMO)), ("many", WAREHOUSE.to_owned())] {
        let dir = bundle(folder.path(), name, &request);
        let html = std::fs::read_to_string(dir.join("report.html")).unwrap();
        for width in [1280, 500] {
            let found = browser::ask(&chromium, folder.path(), &html, width, REPORT).unwrap();
            assert!(
                found["wide"].as_f64() <= found["width"].as_f64(),
                "{name} is cut at {width} px: {} px",
                found["wide"]
            );
            let share = |key: &str, most: f64| {
                let names = found["names"].as_array().unwrap();
                let bad = names.iter().filter(|name| name[key].as_f64().unwrap() > most).count();
                number(bad) / number(names.len().max(1))
            };
            // A third of the letters' height is the room above and below them.
            assert!(
                share("dark", 0.2) < 0.05,
                "{name} at {width} px: {:.0} % of the names on walls",
                100.0 * share("dark", 0.2)
            );
            assert!(
                share("on", 0.1) < 0.02,
                "{name} at {width} px: {:.0} % of the names on others",
                100.0 * share("on", 0.1)
            );
            assert!(share("out", 0.05) < 0.01, "{name} at {width} px: names outside the picture");
            for row in found["rows"].as_array().unwrap() {
                let heights: Vec<f64> = row.as_array().unwrap().iter().filter_map(Value::as_f64).collect();
                assert!(
                    heights.iter().all(|height| (height - heights[0]).abs() < 1.5),
                    "{name} at {width} px: {heights:?}"
                );
            }
            let heads: Vec<&str> = found["heads"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
            let place = |words: &str| heads.iter().position(|head| head.starts_with(words)).unwrap();
            assert!(place("The robot in numbers") < place("Did it happen?"), "{heads:?}");
            // Every sample with a human somewhere is on the curve, however far away.
            let data: Value =
                serde_json::from_str(html.split_once("id=\"data\">").unwrap().1.split_once("</script>").unwrap().0)
                    .unwrap();
            let curve = data["runs"][0]["series"]["distance"].as_array().unwrap();
            let samples: Vec<f64> = curve.iter().filter_map(Value::as_f64).collect();
            assert_eq!(found["points"], json!(samples.len()), "{name}");
            let far = samples.iter().copied().fold(0.0, f64::max) * 1.08 > 5.0;
            assert_eq!(found["bend"], json!(usize::from(far)), "another scale is marked where there is one");
            assert!(found["title"].as_str().unwrap().starts_with("surface distance"));
            assert_eq!(found["signs"], 0, "words in backticks are set as code");
        }
    }
}

/// Rows of a library page, with so many scenarios of which some repeat the first.
fn library(html: &str, rows: usize, repeats: usize) -> String {
    let (before, rest) = html.split_once("id=\"data\">").unwrap();
    let (text, after) = rest.split_once("</script>").unwrap();
    let mut data: Value = serde_json::from_str(text).unwrap();
    let first = data["rows"][0].clone();
    let row = |index: usize| {
        let mut row = first.clone();
        row["folder"] = json!(format!("s-{index}"));
        row["scenario"] = json!(format!("s-{index}"));
        row["repeats"] = if index > 0 && index <= repeats { json!("s-0") } else { Value::Null };
        row
    };
    data["rows"] = (0..rows).map(row).collect();
    format!("{before}id=\"data\">{}</script>{after}", data.to_string().replace('<', "\\u003c"))
}

#[test]
fn a_library_page_has_pages_and_folds_what_repeats() {
    let Some(chromium) = browser::chromium() else { return };
    let folder = tempfile::tempdir().unwrap();
    bundle(folder.path(), "one", WAREHOUSE);
    let made = socrates(folder.path(), "report", &["report", &folder.path().display().to_string()]);
    assert_eq!(made.code, 0, "{}", made.err);
    let html = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    let script = r##"
      const rows = () => [...document.querySelectorAll("#rows > li h3 .tag")].map((n) => n.textContent);
      const first = rows(), pages = [...document.querySelectorAll("#pages button")].map((b) => b.textContent);
      const fold = document.querySelector("#rows .fold"), told = fold.querySelector("summary").textContent;
      fold.open = true; fold.dispatchEvent(new Event("toggle"));
      const inside = fold.querySelectorAll("li a").length;
      [...document.querySelectorAll("#pages button")].find((b) => b.textContent === "2").click();
      const second = rows();
      const select = document.getElementById("fold"); select.value = "shown"; select.dispatchEvent(new Event("change"));
      return { first, second, pages, told, inside, unfolded: rows(), part: document.getElementById("part").textContent,
        wide: document.documentElement.scrollWidth, width: innerWidth };
    "##;
    for width in [1280, 500] {
        let found = browser::ask(&chromium, folder.path(), &library(&html, 200, 120), width, script).unwrap();
        let names = |key: &str| -> Vec<String> {
            found[key].as_array().unwrap().iter().map(|name| name.as_str().unwrap().to_owned()).collect()
        };
        // 80 distinct ones in pages of 30.
        assert_eq!((names("first").len(), names("second").len()), (30, 30), "{found}");
        assert_eq!((names("first")[0].as_str(), names("first")[1].as_str()), ("s-0", "s-121"));
        assert_eq!(names("second")[0], "s-150");
        assert_eq!(names("pages"), ["‹", "1", "2", "3", "›"]);
        assert!(found["told"].as_str().unwrap().starts_with("120 repeats"), "{found}");
        assert_eq!(found["inside"], 120);
        assert_eq!(names("unfolded")[1], "s-1");
        assert_eq!(found["part"], "1 to 30 of 200");
        assert!(found["wide"].as_f64() <= found["width"].as_f64(), "cut at {width} px: {} px", found["wide"]);
    }
}

#[test]
fn a_figure_is_written_as_pdf_with_its_words_and_their_font() {
    let folder = tempfile::tempdir().unwrap();
    let name = bundle(folder.path(), "one", WAREHOUSE).display().to_string();
    let made = socrates(folder.path(), "pdf", &["--format", "json", "figure", &name, "--out", "figure.pdf"]);
    assert_eq!(made.code, 0, "{}", made.err);
    let bytes = std::fs::read(folder.path().join("figure.pdf")).unwrap();
    let has = |words: &str| bytes.windows(words.len()).any(|part| part == words.as_bytes());
    assert!(bytes.starts_with(b"%PDF-1.") && has("/FontFile") && has("Ubuntu-Light") && has("/ToUnicode"));
    let refused = socrates(folder.path(), "bmp", &["figure", &name, "--out", "figure.bmp"]);
    assert!(refused.code == 2 && refused.err.contains(".pdf"), "{}", refused.err);
}
