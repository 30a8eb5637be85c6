//! Draws a tree: `cargo run -p socrates-bt --example draw -- TREE.xml [svg]`.
#![expect(
    clippy::print_stdout,
    clippy::print_stderr,
    clippy::exit,
    clippy::disallowed_methods,
    reason = "a program of its own"
)]

use std::path::Path;

use socrates_bt::{Library, Meaning, Options, Tree, draw_svg, draw_text};

fn main() {
    let mut args = std::env::args().skip(1);
    let path = args.next().unwrap_or_default();
    let is_svg = args.next().as_deref() == Some("svg");
    let library = args.next().and_then(|name| Library::named(&name)).unwrap_or(Library::Native);
    let text = std::fs::read_to_string(&path).unwrap_or_default();
    let find = |name: &str| std::fs::read_to_string(Path::new(&path).parent()?.join(name)).ok();
    let options = Options { includes: Some(&find), library, meaning: Meaning::World, ..Options::default() };
    match Tree::parse_with(&text, &options) {
        Ok(tree) if is_svg => println!("{}", draw_svg(&tree)),
        Ok(tree) => println!("{}", draw_text(&tree)),
        Err(faults) => {
            for fault in faults {
                eprintln!("{fault}");
            }
            std::process::exit(2);
        }
    }
}
