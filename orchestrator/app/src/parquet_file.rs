//! Tables as Parquet files: the runs of a library too large for a spreadsheet, and tracks of exported runs. Behind the feature `parquet`.
//!
//! The columns of runs are those of `index.csv`, each optional: an empty cell has no value. Seeds and numbers of people are integers, figures are
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
use socrates_export::scenario::{Cells, Columns};
use socrates_scoring::metrics::KEY_FIGURES;
use socrates_stream::csv::Row;

use crate::exit::Diagnostic;
use crate::index::DENSITY;

/// Columns of whole numbers.
const WHOLE: [&str; 2] = ["seed", "people"];

/// The values of a column, those that are there.
enum Values {
    Text(Vec<ByteArray>),
    /// Whole numbers without a sign, bit by bit.
    Unsigned(Vec<i64>),
    Signed(Vec<i64>),
    Figure(Vec<f64>),
}

/// A column: which of its rows have a value, and the values.
struct Column<'a> {
    name: &'a str,
    there: Vec<i16>,
    values: Values,
}

impl<'a> Column<'a> {
    fn of<T>(name: &'a str, cells: &[Option<T>], values: Values) -> Self {
        Self { name, there: cells.iter().map(|cell| i16::from(cell.is_some())).collect(), values }
    }

    fn field(&self) -> Result<Type, ParquetError> {
        let (physical, logical) = match self.values {
            Values::Text(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            Values::Unsigned(_) => (Physical::INT64, Some(LogicalType::integer(64, false))),
            Values::Signed(_) => (Physical::INT64, Some(LogicalType::integer(64, true))),
            Values::Figure(_) => (Physical::DOUBLE, None),
        };
        let column = Type::primitive_type_builder(self.name, physical);
        column.with_repetition(Repetition::OPTIONAL).with_logical_type(logical).build()
    }

    fn fill(&self, column: &mut SerializedColumnWriter<'_>) -> Result<usize, ParquetError> {
        let there = Some(self.there.as_slice());
        match &self.values {
            Values::Text(values) => column.typed::<ByteArrayType>().write_batch(values, there, None),
            Values::Unsigned(values) | Values::Signed(values) => {
                column.typed::<Int64Type>().write_batch(values, there, None)
            }
            Values::Figure(values) => column.typed::<DoubleType>().write_batch(values, there, None),
        }
    }
}

/// Writes the cells of these columns, each the place of the column in the rows and its name.
///
/// # Errors
/// A file that cannot be written, or a cell of a column of numbers that is none.
pub(crate) fn write(out: &Path, columns: &[(usize, &str)], rows: &[&Row]) -> Result<(), Diagnostic> {
    let column = |(at, name): &(usize, &'_ str)| {
        let cells: Vec<Option<&str>> = rows.iter().map(|row| row.cell(*at).filter(|cell| !cell.is_empty())).collect();
        let values = if WHOLE.contains(name) {
            Values::Unsigned(numbers::<u64>(name, &cells, rows)?.into_iter().map(u64::cast_signed).collect())
        } else if KEY_FIGURES.contains(name) || *name == DENSITY {
            Values::Figure(numbers::<f64>(name, &cells, rows)?)
        } else {
            Values::Text(cells.iter().flatten().map(|cell| ByteArray::from(*cell)).collect())
        };
        Ok((cells, values))
    };
    let made: Result<Vec<_>, Diagnostic> = columns.iter().map(column).collect();
    let made = made?;
    let columns = columns.iter().zip(made).map(|((_, name), (cells, values))| Column::of(name, &cells, values));
    put(out, "runs", &columns.collect::<Vec<_>>())
}

/// Writes a table of an exporter; the same table gives the same bytes.
///
/// # Errors
/// A file that cannot be written.
pub(crate) fn table(out: &Path, table: &Columns) -> Result<(), Diagnostic> {
    let column = |(name, cells): &'_ (&'static str, Cells)| match cells {
        Cells::Whole(values) => Column::of(name, values, Values::Signed(values.iter().flatten().copied().collect())),
        Cells::Real(values) => Column::of(name, values, Values::Figure(values.iter().flatten().copied().collect())),
        Cells::Text(values) => {
            let texts = values.iter().flatten().map(|text| ByteArray::from(text.as_str())).collect();
            Column::of(name, values, Values::Text(texts))
        }
    };
    put(out, table.name, &table.columns.iter().map(column).collect::<Vec<_>>())
}

fn put(out: &Path, name: &str, columns: &[Column<'_>]) -> Result<(), Diagnostic> {
    let cannot = |why: String| {
        Diagnostic::input(format!("cannot write `{}`: {why}", out.display()), "--out chooses another place")
    };
    let fields: Result<Vec<Arc<Type>>, ParquetError> =
        columns.iter().map(|column| column.field().map(Arc::new)).collect();
    let schema = fields.and_then(|fields| Type::group_type_builder(name).with_fields(fields).build());
    let schema = Arc::new(schema.map_err(|why| cannot(why.to_string()))?);
    let file = File::create(out).map_err(|why| cannot(why.to_string()))?;
    let properties = Arc::new(WriterProperties::builder().build());
    let mut writer = SerializedFileWriter::new(file, schema, properties).map_err(|why| cannot(why.to_string()))?;
    let mut group = writer.next_row_group().map_err(|why| cannot(why.to_string()))?;
    for one in columns {
        let column = group.next_column().map_err(|why| cannot(why.to_string()))?;
        let mut column = column.ok_or_else(|| cannot(format!("no room for `{}`", one.name)))?;
        one.fill(&mut column).map_err(|why| cannot(why.to_string()))?;
        column.close().map_err(|why| cannot(why.to_string()))?;
    }
    group.close().map_err(|why| cannot(why.to_string()))?;
    writer.close().map_err(|why| cannot(why.to_string()))?;
    Ok(())
}

fn numbers<T: std::str::FromStr>(name: &str, cells: &[Option<&str>], rows: &[&Row]) -> Result<Vec<T>, Diagnostic> {
    let filled = cells.iter().zip(rows).filter_map(|(cell, row)| Some(((*cell)?, row.line)));
    let number = |(cell, line): (&str, usize)| {
        cell.parse().map_err(|_bad| {
            let what = format!("line {line} of the table: `{cell}` is no number, and `{name}` is a column of numbers");
            Diagnostic::input(what, "`socrates library gallery LIBRARY` writes the table anew")
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

    fn written(text: &str) -> Result<Vec<Vec<(String, Field)>>, Diagnostic> {
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
    fn a_table_of_an_exporter_is_read_back_and_has_the_same_bytes_again() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("tracks.parquet");
        let columns = vec![
            ("tick", Cells::Whole(vec![Some(-1), None])),
            ("x_m", Cells::Real(vec![Some(0.25), Some(1e-6)])),
            ("leaf", Cells::Text(vec![None, Some("Büro".to_owned())])),
        ];
        let tracks = Columns { name: "tracks", columns };
        table(&out, &tracks).unwrap();
        let bytes = std::fs::read(&out).unwrap();
        table(&out, &tracks).unwrap();
        assert_eq!(std::fs::read(&out).unwrap(), bytes);
        let reader = SerializedFileReader::new(File::open(&out).unwrap()).unwrap();
        let rows: Vec<Vec<Field>> = reader
            .get_row_iter(None)
            .unwrap()
            .map(|row| row.unwrap().get_column_iter().map(|(_, field)| field.clone()).collect())
            .collect();
        assert_eq!(rows[0], [Field::Long(-1), Field::Double(0.25), Field::Null]);
        assert_eq!(rows[1], [Field::Null, Field::Double(1e-6), Field::Str("Büro".to_owned())]);
        let told = table(folder.path(), &tracks).unwrap_err();
        assert!(told.what.contains("cannot write"), "{}", told.what);
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
