//! Tables of a Markdown document.

/// The cells of a table's rows, without its head: those of the first table under this heading.
pub(super) fn under(text: &str, heading: &str) -> Vec<Vec<String>> {
    let lines = text.lines().skip_while(|line| line.trim() != heading).skip(1);
    let table = lines.take_while(|line| !line.starts_with('#')).skip_while(|line| !line.starts_with('|'));
    let rows = table.take_while(|line| line.starts_with('|')).skip(2);
    rows.map(|row| row.trim().trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()).collect()
}

/// The words of a cell that stand in backticks.
pub(super) fn names(cell: &str) -> Vec<String> {
    cell.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

#[test]
fn a_table_is_read_from_under_its_heading() {
    let text = "# One\n| a |\n|---|\n| `x` |\n## Two\nwords\n\n| a | b |\n|---|---|\n| `y` | `z` and `w` |\n| – | |\n\n| c |\n";
    let rows = under(text, "## Two");
    assert_eq!(rows, [["`y`", "`z` and `w`"], ["–", ""]]);
    assert_eq!((names(&rows[0][1]), names(&rows[1][0])), (vec!["z".to_owned(), "w".to_owned()], Vec::new()));
    assert!(under(text, "## Three").is_empty());
}
