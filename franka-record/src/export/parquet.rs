//! Tables as Parquet files. They contain numbers, texts, and lists of a fixed length, without
//! missing values.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use ::parquet::basic::{Compression, ConvertedType, Repetition, Type as Physical};
use ::parquet::column::writer::ColumnWriter;
use ::parquet::data_type::ByteArray;
use ::parquet::errors::{ParquetError, Result};
use ::parquet::file::metadata::KeyValue;
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::writer::SerializedFileWriter;
use ::parquet::schema::types::{Type, TypePtr};

use super::error::ExportError;
use super::new_file::NewFile;

/// A column of a table: name, type, and number of values per row.
#[derive(Clone, Debug)]
pub(crate) struct Field {
    pub(crate) name: String,
    pub(crate) kind: Kind,
    /// Length of a list; `None` for one value per row.
    pub(crate) length: Option<usize>,
}

/// The type of a column's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Bool,
    Int,
    Single,
    Double,
    Text,
}

/// The values of a column, row after row.
#[derive(Clone, Debug)]
pub(crate) enum Values {
    Bool(Vec<bool>),
    Int(Vec<i64>),
    Single(Vec<f32>),
    Double(Vec<f64>),
    Text(Vec<String>),
}

impl Field {
    pub(crate) fn new(name: impl Into<String>, kind: Kind) -> Self {
        let name = name.into();
        Self {
            name,
            kind,
            length: None,
        }
    }

    pub(crate) fn list(name: impl Into<String>, kind: Kind, length: usize) -> Self {
        Self {
            length: Some(length),
            ..Self::new(name, kind)
        }
    }

    fn schema(&self) -> Result<Type> {
        let physical = match self.kind {
            Kind::Bool => Physical::BOOLEAN,
            Kind::Int => Physical::INT64,
            Kind::Single => Physical::FLOAT,
            Kind::Double => Physical::DOUBLE,
            Kind::Text => Physical::BYTE_ARRAY,
        };
        let value = |name: &str| {
            let is_text = self.kind == Kind::Text;
            Type::primitive_type_builder(name, physical)
                .with_repetition(Repetition::REQUIRED)
                .with_converted_type(if is_text {
                    ConvertedType::UTF8
                } else {
                    ConvertedType::NONE
                })
                .build()
        };
        if self.length.is_none() {
            return value(&self.name);
        }
        let each = Type::group_type_builder("list")
            .with_repetition(Repetition::REPEATED)
            .with_fields(vec![Arc::new(value("element")?)])
            .build()?;
        Type::group_type_builder(&self.name)
            .with_repetition(Repetition::REQUIRED)
            .with_converted_type(ConvertedType::LIST)
            .with_fields(vec![Arc::new(each)])
            .build()
    }
}

/// A table that is being written. The file appears under its name once the table is complete.
pub(crate) struct TableWriter {
    path: PathBuf,
    fields: Vec<Field>,
    writer: SerializedFileWriter<NewFile>,
}

impl TableWriter {
    /// Creates a table in `file`, with `notes` in its metadata.
    pub(crate) fn new(
        file: NewFile,
        fields: Vec<Field>,
        notes: &[(&str, String)],
    ) -> std::result::Result<Self, ExportError> {
        let path = file.path().to_owned();
        let begin = || {
            let notes = notes
                .iter()
                .map(|(key, text)| KeyValue::new((*key).to_owned(), text.clone()));
            let properties = WriterProperties::builder()
                .set_compression(Compression::SNAPPY)
                .set_key_value_metadata(Some(notes.collect()))
                .build();
            SerializedFileWriter::new(file, schema(&fields)?, Arc::new(properties))
        };
        let writer = begin().map_err(at(&path))?;
        Ok(Self {
            path,
            fields,
            writer,
        })
    }

    /// Appends rows, as one list of values for each field, in the order of the fields.
    pub(crate) fn write(&mut self, columns: &[Values]) -> std::result::Result<(), ExportError> {
        debug_assert_eq!(columns.len(), self.fields.len());
        let Self { fields, writer, .. } = self;
        let mut append = || {
            let mut rows = writer.next_row_group()?;
            for (field, values) in fields.iter().zip(columns) {
                let Some(mut column) = rows.next_column()? else {
                    return Err(ParquetError::General(format!("no column {}", field.name)));
                };
                append(column.untyped(), field.length, values)?;
                column.close()?;
            }
            rows.close()
        };
        append().map(|_| ()).map_err(at(&self.path))
    }

    /// Returns the number of bytes written so far.
    pub(crate) fn size(&self) -> usize {
        self.writer.bytes_written()
    }

    /// Completes the file and renames it to its final name.
    pub(crate) fn finish(self) -> std::result::Result<(), ExportError> {
        let file = self.writer.into_inner().map_err(at(&self.path))?;
        file.finish()
    }
}

fn schema(fields: &[Field]) -> Result<TypePtr> {
    let fields = fields.iter().map(|field| field.schema().map(Arc::new));
    let root = Type::group_type_builder("schema").with_fields(fields.collect::<Result<_>>()?);
    Ok(Arc::new(root.build()?))
}

fn append(column: &mut ColumnWriter<'_>, length: Option<usize>, values: &Values) -> Result<()> {
    let count = values.len();
    // No value of a list is missing, and every `length`-th value begins a row.
    let levels = length.map(|length| {
        let repetitions = (0..count).map(|i| i16::from(i % length != 0));
        (vec![1; count], repetitions.collect::<Vec<i16>>())
    });
    let (definitions, repetitions) = match &levels {
        Some((definitions, repetitions)) => (Some(&definitions[..]), Some(&repetitions[..])),
        None => (None, None),
    };
    match (column, values) {
        (ColumnWriter::BoolColumnWriter(to), Values::Bool(of)) => {
            to.write_batch(of, definitions, repetitions)?
        }
        (ColumnWriter::Int64ColumnWriter(to), Values::Int(of)) => {
            to.write_batch(of, definitions, repetitions)?
        }
        (ColumnWriter::FloatColumnWriter(to), Values::Single(of)) => {
            to.write_batch(of, definitions, repetitions)?
        }
        (ColumnWriter::DoubleColumnWriter(to), Values::Double(of)) => {
            to.write_batch(of, definitions, repetitions)?
        }
        (ColumnWriter::ByteArrayColumnWriter(to), Values::Text(of)) => {
            let of: Vec<ByteArray> = of.iter().map(|text| text.as_str().into()).collect();
            to.write_batch(&of, definitions, repetitions)?
        }
        _ => return Err(ParquetError::General("values of another kind".into())),
    };
    Ok(())
}

impl Values {
    /// Returns the values as numbers. Flags become 0 or 1. The list is empty for texts.
    pub(crate) fn numbers(&self) -> Vec<f64> {
        match self {
            Self::Bool(values) => values.iter().map(|x| f64::from(u8::from(*x))).collect(),
            Self::Int(values) => values.iter().map(|x| *x as f64).collect(),
            Self::Single(values) => values.iter().map(|x| f64::from(*x)).collect(),
            Self::Double(values) => values.clone(),
            Self::Text(_) => Vec::new(),
        }
    }

    /// Number of values.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Bool(values) => values.len(),
            Self::Int(values) => values.len(),
            Self::Single(values) => values.len(),
            Self::Double(values) => values.len(),
            Self::Text(values) => values.len(),
        }
    }
}

pub(crate) fn at(path: &Path) -> impl FnOnce(ParquetError) -> ExportError {
    let path = path.to_owned();
    move |source| ExportError::Table { path, source }
}
