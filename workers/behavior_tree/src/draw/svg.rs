//! Trees as SVG: the root on the left, children to its right from top to bottom, in the order they are ticked.
//!
//! Every node owns a horizontal band that holds its box and the bands of its children, so that no two boxes can
//! overlap. Colors are those of Okabe and Ito, which color-blind readers tell apart; kinds also differ in shape.

use quick_xml::escape::escape;

use crate::draw::{is_subtree, kind_word, own_name, title};
use crate::sheet::{Kind, NodeSheet};
use crate::tree::{Node, Tree};

/// Sizes in pixels. Letters are not measured but taken as wide as the widest common sans-serif makes them.
const TITLE_LETTER: f64 = 8.3;
const PORT_LETTER: f64 = 6.1;
const MOST_TITLE_LETTERS: usize = 34;
const MOST_PORT_LETTERS: usize = 40;
const TITLE_LINE: f64 = 17.0;
const PORT_LINE: f64 = 14.0;
const PADDING: f64 = 9.0;
const COLUMN_GAP: f64 = 44.0;
const ROW_GAP: f64 = 12.0;
const MARGIN: f64 = 24.0;
const HEAD: f64 = 58.0;
const LEAST_BOX: f64 = 84.0;
/// Least width of the page: the legend must fit.
const LEAST_PAGE: f64 = 560.0;

/// Line, fill and corner radius of a kind.
const fn look(sheet: &NodeSheet, is_subtree: bool) -> (&'static str, &'static str, f64) {
    match sheet.kind {
        Kind::Decorator if is_subtree => ("#4d4d4d", "#f0f0f0", 2.0),
        Kind::Control => ("#0072b2", "#e2f0f9", 2.0),
        Kind::Decorator => ("#b0558a", "#f8e8f1", 8.0),
        Kind::Condition => ("#8f5f00", "#fdf1d8", 15.0),
        Kind::Action => ("#00805d", "#def3eb", 5.0),
    }
}

/// A line of a box: its text, cut where it is too long.
struct Line {
    text: String,
    is_title: bool,
    is_name: bool,
}

/// A box before it has a place.
struct Block {
    lines: Vec<Line>,
    width: f64,
    height: f64,
    /// Height of the band of the node.
    band: f64,
    left: f64,
    /// Top of the band.
    top: f64,
}

impl Block {
    fn of(node: &Node) -> Self {
        let mut lines = vec![Line { text: cut(title(node), MOST_TITLE_LETTERS), is_title: true, is_name: false }];
        if let Some(name) = own_name(node) {
            lines.push(Line { text: cut(name, MOST_PORT_LETTERS), is_title: false, is_name: true });
        }
        for (name, value) in &node.attrs {
            let text = cut(&format!("{name} = {value}"), MOST_PORT_LETTERS);
            lines.push(Line { text, is_title: false, is_name: false });
        }
        let letters = |line: &Line| line.text.chars().map(columns).sum::<f64>();
        let width_of = |line: &Line| letters(line) * if line.is_title { TITLE_LETTER } else { PORT_LETTER };
        let width = lines.iter().map(width_of).fold(LEAST_BOX - 2.0 * PADDING, f64::max) + 2.0 * PADDING;
        let height = TITLE_LINE + PORT_LINE * (lines.len() - 1) as f64 + PADDING;
        Self { lines, width, height, band: height, left: 0.0, top: 0.0 }
    }

    fn middle(&self) -> f64 {
        self.top + self.band / 2.0
    }
}

/// Letters of East Asian scripts and pictures take two columns.
fn columns(letter: char) -> f64 {
    if u32::from(letter) >= 0x1100 { 1.8 } else { 1.0 }
}

/// A text of at most so many letters; a longer one ends in `…`, and breaks become blanks.
fn cut(text: &str, most: usize) -> String {
    let flat = text.replace(|c: char| c.is_whitespace() || c.is_control(), " ");
    if flat.chars().count() <= most {
        return flat;
    }
    flat.chars().take(most - 1).chain(std::iter::once('…')).collect()
}

/// The tree as an SVG document, white background, as wide and high as it needs.
#[must_use]
pub fn draw_svg(tree: &Tree) -> String {
    let blocks = layout(tree);
    let right = blocks.iter().map(|block| block.left + block.width).fold(0.0, f64::max);
    let bottom = blocks.first().map_or(0.0, |root| root.top + root.band);
    let width = (right + MARGIN).max(LEAST_PAGE);
    let height = bottom + MARGIN;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
         viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"DejaVu Sans, Verdana, Arial, sans-serif\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
    );
    head(tree, &mut svg);
    for (node, block) in tree.nodes.iter().zip(&blocks) {
        if let Some(parent) = node.parent.and_then(|parent| blocks.get(parent)) {
            edge(parent, block, &mut svg);
        }
    }
    for (node, block) in tree.nodes.iter().zip(&blocks) {
        boxed(node, block, &mut svg);
    }
    svg.push_str("</svg>\n");
    svg
}

/// Boxes with their places. Parents come before their children in the array, so that one pass backwards gives
/// the heights of the bands and one forwards their places.
fn layout(tree: &Tree) -> Vec<Block> {
    let mut blocks: Vec<Block> = tree.nodes.iter().map(Block::of).collect();
    for index in (0..blocks.len()).rev() {
        let children = tree.nodes.get(index).map_or(&[][..], |node| node.children.as_slice());
        let below = stacked(&blocks, children);
        if let Some(block) = blocks.get_mut(index) {
            block.band = block.band.max(below);
        }
    }
    if let Some(root) = blocks.first_mut() {
        root.top = HEAD;
        root.left = MARGIN;
    }
    for index in 0..blocks.len() {
        let Some(block) = blocks.get(index) else { continue };
        let (top, band) = (block.top, block.band);
        let left = block.left + block.width + COLUMN_GAP;
        let children = tree.nodes.get(index).map_or(&[][..], |node| node.children.as_slice());
        let mut next = top + (band - stacked(&blocks, children)) / 2.0;
        for child in children {
            if let Some(child) = blocks.get_mut(*child) {
                child.top = next;
                child.left = left;
                next += child.band + ROW_GAP;
            }
        }
    }
    blocks
}

/// Height of the bands of some nodes, one above the other.
fn stacked(blocks: &[Block], children: &[usize]) -> f64 {
    let bands: f64 = children.iter().filter_map(|child| blocks.get(*child)).map(|child| child.band + ROW_GAP).sum();
    (bands - ROW_GAP).max(0.0)
}

fn head(tree: &Tree, svg: &mut String) {
    let n = tree.nodes.len();
    let noun = if n == 1 { "node" } else { "nodes" };
    let name = cut(&tree.document.main, 60);
    svg.push_str(&format!(
        "<text x=\"{MARGIN}\" y=\"24\" font-size=\"15\" font-weight=\"bold\" fill=\"#222222\">{}</text>\n\
         <text x=\"{MARGIN}\" y=\"43\" font-size=\"10\" fill=\"#555555\">{}, {n} {noun}</text>\n",
        escape(name.as_str()),
        tree.format.name()
    ));
    let mut left = MARGIN + 110.0;
    let mut shown: Vec<&str> = Vec::new();
    for node in tree.nodes.iter() {
        let word = kind_word(node.sheet);
        if shown.contains(&word) {
            continue;
        }
        shown.push(word);
        let (line, fill, radius) = look(node.sheet, is_subtree(node.sheet));
        let radius = radius.min(5.5);
        svg.push_str(&format!(
            "<rect x=\"{left:.0}\" y=\"34\" width=\"18\" height=\"11\" rx=\"{radius}\" fill=\"{fill}\" stroke=\"{line}\" stroke-width=\"1.5\"/>\
             <text x=\"{:.0}\" y=\"43\" font-size=\"10\" fill=\"#333333\">{word}</text>\n",
            left + 24.0
        ));
        left += 24.0 + PORT_LETTER * word.len() as f64 + 16.0;
    }
}

/// From the right side of the parent to the left side of the child, with a bend between the columns.
fn edge(parent: &Block, child: &Block, svg: &mut String) {
    let (x0, y0) = (parent.left + parent.width, parent.middle());
    let (x1, y1) = (child.left, child.middle());
    let bend = x1 - COLUMN_GAP / 2.0;
    svg.push_str(&format!(
        "<path d=\"M{x0:.1} {y0:.1} H{bend:.1} V{y1:.1} H{x1:.1}\" fill=\"none\" stroke=\"#8a8a8a\" stroke-width=\"1.3\" stroke-linejoin=\"round\"/>\n"
    ));
}

fn boxed(node: &Node, block: &Block, svg: &mut String) {
    let (line, fill, radius) = look(node.sheet, is_subtree(node.sheet));
    let top = block.middle() - block.height / 2.0;
    let dash = if is_subtree(node.sheet) { " stroke-dasharray=\"5 3\"" } else { "" };
    let mut full = title(node).to_owned();
    if let Some(name) = own_name(node) {
        full.push_str(&format!(" `{name}`"));
    }
    for (name, value) in &node.attrs {
        full.push_str(&format!("\n{name} = {value}"));
    }
    full.push_str(&format!("\n{}", node.sheet.about));
    svg.push_str(&format!(
        "<g><title>{}</title><rect x=\"{:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\" rx=\"{radius}\" fill=\"{fill}\" stroke=\"{line}\" stroke-width=\"1.6\"{dash}/>",
        escape(full.as_str()),
        block.left,
        block.width,
        block.height
    ));
    let left = block.left + PADDING;
    let mut base = top + PADDING / 2.0 + 12.5;
    for text in &block.lines {
        let (size, weight, color) = if text.is_title {
            (12, " font-weight=\"bold\"", line)
        } else if text.is_name {
            (10, " font-style=\"italic\"", "#333333")
        } else {
            (10, "", "#333333")
        };
        svg.push_str(&format!(
            "<text x=\"{left:.1}\" y=\"{base:.1}\" font-size=\"{size}\"{weight} fill=\"{color}\" xml:space=\"preserve\">{}</text>",
            escape(text.text.as_str())
        ));
        base += if text.is_title { TITLE_LINE - 2.0 } else { PORT_LINE };
    }
    svg.push_str("</g>\n");
}
