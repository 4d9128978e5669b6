//! A sweep's table as Parquet: a column of numbers is DOUBLE, any other UTF-8, both optional.

use crate::output::Failure;
use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::sync::Arc;
use washboard::study::{Cell, SweepTable};

/// The bytes of `table.parquet`, without compression: it is small, and no compressor has to be linked.
pub fn bytes(table: &SweepTable) -> Result<Vec<u8>, Failure> {
    written(table).map_err(|e| Failure::of_computation(format!("table.parquet: {e}")))
}

fn written(table: &SweepTable) -> Result<Vec<u8>, ParquetError> {
    let column = |k: usize| table.rows.iter().map(move |row| &row[k]);
    let is_number = |k: usize| !column(k).any(|c| matches!(c, Cell::Text(_)));
    let field = |(k, name): (usize, &String)| -> Result<Arc<Type>, ParquetError> {
        let (physical, logical) = if is_number(k) {
            (Physical::DOUBLE, None)
        } else {
            (Physical::BYTE_ARRAY, Some(LogicalType::String))
        };
        let own = Type::primitive_type_builder(name, physical).with_logical_type(logical);
        Ok(Arc::new(own.with_repetition(Repetition::OPTIONAL).build()?))
    };
    let fields = table.columns.iter().enumerate().map(field).collect::<Result<Vec<_>, _>>()?;
    let schema = Arc::new(Type::group_type_builder("sweep").with_fields(fields).build()?);
    let mut file =
        SerializedFileWriter::new(Vec::new(), schema, Arc::new(WriterProperties::builder().build()))?;
    let mut rows = file.next_row_group()?;
    let mut k = 0;
    while let Some(mut place) = rows.next_column()? {
        let there: Vec<i16> = column(k).map(|c| i16::from(*c != Cell::Empty)).collect();
        if is_number(k) {
            let number = |c: &Cell| if let Cell::Number(v) = c { Some(*v) } else { None };
            let values: Vec<f64> = column(k).filter_map(number).collect();
            place.typed::<DoubleType>().write_batch(&values, Some(&there), None)?;
        } else {
            let text = |c: &Cell| (*c != Cell::Empty).then(|| ByteArray::from(c.text().into_bytes()));
            let values: Vec<ByteArray> = column(k).filter_map(text).collect();
            place.typed::<ByteArrayType>().write_batch(&values, Some(&there), None)?;
        }
        place.close()?;
        k += 1;
    }
    rows.close()?;
    file.into_inner()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::RowAccessor;

    #[test]
    fn what_is_written_is_read_back() {
        let table = SweepTable {
            columns: vec!["override.c".into(), "status".into(), "rms".into()],
            rows: vec![
                vec![Cell::Number(0.1), Cell::Text("designed".into()), Cell::Number(2.0)],
                vec![Cell::Number(0.3), Cell::Text("stalled".into()), Cell::Empty],
            ],
        };
        let path = std::env::temp_dir().join(format!("washboard-{}.parquet", std::process::id()));
        std::fs::write(&path, bytes(&table).unwrap()).unwrap();
        let reader = SerializedFileReader::new(std::fs::File::open(&path).unwrap()).unwrap();
        std::fs::remove_file(&path).unwrap();
        let rows: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        assert_eq!((rows.len(), rows[1].get_double(0).unwrap()), (2, 0.3));
        assert_eq!(rows[0].get_string(1).unwrap(), "designed");
        assert!(rows[0].get_double(2).is_ok() && rows[1].get_double(2).is_err());
    }
}
