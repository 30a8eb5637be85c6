//! The table of runs as a Parquet file, for libraries too large for a spreadsheet. Behind the feature `parquet`.
//!
//! The columns are those of `index.csv`, each optional: an empty cell has no value. Seeds and numbers of people are integers, figures are
//! doubles, everything else is text. One row group, dictionaries where they help, nothing packed: the file needs no codec to be read.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;
use socrates_scoring::metrics::KEY_FIGURES;
use socrates_stream::csv::Row;

use crate::exit::Complaint;
use crate::index::DENSITY;

/// Columns of whole numbers.
const WHOLE: [&str; 2] = ["seed", "people"];

/// What the cells of a column are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Text,
    Whole,
    Figure,
}

impl Kind {
    fn of(column: &str) -> Self {
        if WHOLE.contains(&column) {
            Self::Whole
        } else if KEY_FIGURES.contains(&column) || column == DENSITY {
            Self::Figure
        } else {
            Self::Text
        }
    }

    fn column(self, name: &str) -> Result<Type, ParquetError> {
        let (physical, logical) = match self {
            Self::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            Self::Whole => (Physical::INT64, Some(LogicalType::integer(64, false))),
            Self::Figure => (Physical::DOUBLE, None),
        };
        let column = Type::primitive_type_builder(name, physical);
        column.with_repetition(Repetition::OPTIONAL).with_logical_type(logical).build()
    }
}

/// Writes the cells of these columns, each the place of the column in the rows and its name.
///
/// # Errors
/// A file that cannot be written, or a cell of a column of numbers that is none.
pub(crate) fn write(out: &Path, columns: &[(usize, &str)], rows: &[&Row]) -> Result<(), Complaint> {
    let cannot = |why: String| {
        Complaint::input(format!("cannot write `{}`: {why}", out.display()), "--out chooses another place")
    };
    let fields: Result<Vec<Arc<Type>>, ParquetError> =
        columns.iter().map(|(_, name)| Kind::of(name).column(name).map(Arc::new)).collect();
    let schema = fields.and_then(|fields| Type::group_type_builder("runs").with_fields(fields).build());
    let schema = Arc::new(schema.map_err(|why| cannot(why.to_string()))?);
    let file = File::create(out).map_err(|why| cannot(why.to_string()))?;
    let properties = Arc::new(WriterProperties::builder().build());
    let mut writer = SerializedFileWriter::new(file, schema, properties).map_err(|why| cannot(why.to_string()))?;
    let mut group = writer.next_row_group().map_err(|why| cannot(why.to_string()))?;
    for (at, name) in columns {
        let column = group.next_column().map_err(|why| cannot(why.to_string()))?;
        let mut column = column.ok_or_else(|| cannot(format!("no room for `{name}`")))?;
        let cells: Vec<Option<&str>> = rows.iter().map(|row| row.cell(*at).filter(|cell| !cell.is_empty())).collect();
        filled(&mut column, name, &cells, rows)?.map_err(|why| cannot(why.to_string()))?;
        column.close().map_err(|why| cannot(why.to_string()))?;
    }
    group.close().map_err(|why| cannot(why.to_string()))?;
    writer.close().map_err(|why| cannot(why.to_string()))?;
    Ok(())
}

/// Fills a column.
fn filled(
    column: &mut SerializedColumnWriter<'_>,
    name: &str,
    cells: &[Option<&str>],
    rows: &[&Row],
) -> Result<Result<usize, ParquetError>, Complaint> {
    let there: Vec<i16> = cells.iter().map(|cell| i16::from(cell.is_some())).collect();
    Ok(match Kind::of(name) {
        Kind::Text => {
            let values: Vec<ByteArray> = cells.iter().flatten().map(|cell| ByteArray::from(*cell)).collect();
            column.typed::<ByteArrayType>().write_batch(&values, Some(&there), None)
        }
        Kind::Whole => {
            let values: Vec<i64> = numbers::<u64>(name, cells, rows)?.into_iter().map(u64::cast_signed).collect();
            column.typed::<Int64Type>().write_batch(&values, Some(&there), None)
        }
        Kind::Figure => {
            let values = numbers::<f64>(name, cells, rows)?;
            column.typed::<DoubleType>().write_batch(&values, Some(&there), None)
        }
    })
}

fn numbers<T: std::str::FromStr>(name: &str, cells: &[Option<&str>], rows: &[&Row]) -> Result<Vec<T>, Complaint> {
    let filled = cells.iter().zip(rows).filter_map(|(cell, row)| Some(((*cell)?, row.line)));
    let number = |(cell, line): (&str, usize)| {
        cell.parse().map_err(|_bad| {
            let what = format!("line {line} of the table: `{cell}` is no number, and `{name}` is a column of numbers");
            Complaint::input(what, "`socrates library gallery LIBRARY` writes the table anew")
        })
    };
    filled.map(number).collect()
}

#[cfg(test)]
mod tests {
    use parquet::file::reader::{FileReader as _, SerializedFileReader};
    use parquet::record::Field;
    use socrates_stream::csv::Table;

    use super::*;

    fn written(text: &str) -> Result<Vec<Vec<(String, Field)>>, Complaint> {
        let table = Table::read(text).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("index.parquet");
        let columns: Vec<(usize, &str)> = table.head.cells.iter().map(String::as_str).enumerate().collect();
        write(&out, &columns, &table.rows.iter().collect::<Vec<_>>())?;
        let reader = SerializedFileReader::new(File::open(out).unwrap()).unwrap();
        let rows = reader.get_row_iter(None).unwrap();
        let cells = |row: parquet::record::Row| {
            row.get_column_iter().map(|(name, field)| (name.clone(), field.clone())).collect()
        };
        Ok(rows.map(|row| cells(row.unwrap())).collect())
    }

    #[test]
    fn a_table_is_read_back_with_its_numbers_and_without_what_it_lacks() {
        let text = "request,seed,verdict,human_distance_min,people\nhall,1,realised,0.25,2\n\"a, b\",18446744073709551615,failed,,\n";
        let rows = written(text).unwrap();
        let field = |row: usize, name: &str| rows[row].iter().find(|(column, _)| column == name).unwrap().1.clone();
        assert_eq!(rows.len(), 2);
        assert_eq!(field(0, "request"), Field::Str("hall".to_owned()));
        assert_eq!((field(0, "human_distance_min"), field(0, "people")), (Field::Double(0.25), Field::ULong(2)));
        assert_eq!(field(1, "request"), Field::Str("a, b".to_owned()));
        assert_eq!(field(1, "seed"), Field::ULong(u64::MAX), "no digit of a seed is lost");
        assert_eq!((field(1, "human_distance_min"), field(1, "people")), (Field::Null, Field::Null));
    }

    #[test]
    fn a_figure_that_is_no_number_is_named_by_its_line() {
        let why = written("request,jerk_mean\nhall,0.5\nhall,fast\n").unwrap_err();
        assert!(
            why.what.contains("line 3") && why.what.contains("`fast`") && why.what.contains("`jerk_mean`"),
            "{why}"
        );
    }
}
