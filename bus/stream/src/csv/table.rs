//! A table of text: cells with the numbers of their lines. Everybody here who reads CSV reads it through this.

use super::bad;
use crate::error::StreamError;

/// What may stand between cells; the first that the head holds is meant.
const SEPARATORS: [char; 3] = [',', ';', '\t'];

/// A line of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row {
    /// Number of the line in the file, from 1.
    pub line: usize,
    /// Cells without the blanks around them; in quotes a separator and a line break are text, and two quotes are one.
    pub cells: Vec<String>,
}

/// A table with its head.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// What stands between the cells: a comma, a semicolon or a tab.
    pub separator: char,
    /// The first line that holds anything: names of columns, in small letters.
    pub head: Row,
    /// The lines below it that hold anything. They may have fewer or more cells than the head.
    pub rows: Vec<Row>,
}

impl Table {
    /// Reads a table (RFC 4180) whose cells are separated by commas, semicolons or tabs.
    ///
    /// # Errors
    /// [`StreamError::Csv`] where the text holds nothing.
    pub fn read(text: &str) -> Result<Self, StreamError> {
        let text = text.trim_start_matches('\u{feff}');
        let first = text.lines().find(|line| !line.trim().is_empty()).unwrap_or_default();
        let separator = SEPARATORS.into_iter().find(|separator| first.contains(*separator)).unwrap_or(',');
        let mut reader = ::csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(u8::try_from(separator).unwrap_or(b','))
            // A tab may separate cells, hence the trimming by hand.
            .trim(::csv::Trim::None)
            .from_reader(text.as_bytes());
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|why| bad(line_of(text, why.position()), &why.to_string()))?;
            let cells: Vec<String> = record.iter().map(|cell| cell.trim().to_owned()).collect();
            if cells.iter().any(|cell| !cell.is_empty()) {
                rows.push(Row { line: line_of(text, record.position()), cells });
            }
        }
        if rows.is_empty() {
            return Err(bad(1, "the file is empty; a line with the names of the columns is needed"));
        }
        let mut head = rows.remove(0);
        head.cells.iter_mut().for_each(|name| *name = name.to_lowercase());
        Ok(Self { separator, head, rows })
    }

    /// Place of a column by its name in small letters.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<usize> {
        self.head.cells.iter().position(|cell| cell == name)
    }

    /// Number of the last line that holds anything.
    pub(super) fn last_line(&self) -> usize {
        self.rows.last().map_or(self.head.line, |row| row.line)
    }
}

impl Row {
    /// The cell at a place; nothing where the line is shorter.
    #[must_use]
    pub fn cell(&self, at: usize) -> Option<&str> {
        self.cells.get(at).map(String::as_str)
    }

    /// The finite number at a place.
    #[must_use]
    pub fn number(&self, at: usize) -> Option<f64> {
        self.cell(at)?.parse::<f64>().ok().filter(|value| value.is_finite())
    }
}

/// The line on which a record stands; its position is that of the empty lines before it.
fn line_of(text: &str, position: Option<&::csv::Position>) -> usize {
    let Some(position) = position else { return 1 };
    let number = |of: u64| usize::try_from(of).unwrap_or(usize::MAX);
    let rest = text.as_bytes().get(number(position.byte())..).unwrap_or_default();
    let empty = rest.iter().take_while(|byte| matches!(byte, b'\r' | b'\n')).filter(|byte| **byte == b'\n').count();
    number(position.line()) + empty
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_hold_separators_quotes_and_line_breaks() {
        let table =
            Table::read("\u{feff}\nName, Note\r\n\"Ann, 7\",\"said \"\"no\"\"\"\n\n\"two\nlines\", x \n").unwrap();
        assert_eq!((table.head.line, table.head.cells.join("|")), (2, "name|note".to_owned()));
        let cells: Vec<(usize, String)> = table.rows.iter().map(|row| (row.line, row.cells.join("|"))).collect();
        assert_eq!(cells, [(3, "Ann, 7|said \"no\"".to_owned()), (5, "two\nlines|x".to_owned())]);
    }

    #[test]
    fn an_empty_cell_of_a_table_with_tabs_stays_a_cell() {
        let table = Table::read("a\tb\tc\n1\t\t3\n").unwrap();
        assert_eq!(table.rows[0].cells, ["1", "", "3"]);
    }

    #[test]
    fn a_quote_that_never_ends_takes_the_rest_and_breaks_nothing() {
        let table = Table::read("a,b\n1,\"2\n3,4\n").unwrap();
        assert_eq!(table.rows[0].cells, ["1", "2\n3,4"]);
    }
}
