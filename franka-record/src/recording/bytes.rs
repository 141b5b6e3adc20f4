//! The bytes of a recording, in a file or in memory.

use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::sync::{Arc, Mutex, PoisonError};

/// The source of a recording.
#[derive(Clone, Debug)]
pub(super) struct Bytes {
    store: Store,
    length: u64,
}

#[derive(Clone, Debug)]
enum Store {
    File(Arc<Mutex<File>>),
    Memory(Arc<[u8]>),
}

impl Bytes {
    pub(super) fn of_file(mut file: File) -> io::Result<Self> {
        let length = file.seek(SeekFrom::End(0))?;
        Ok(Self {
            store: Store::File(Arc::new(Mutex::new(file))),
            length,
        })
    }

    pub(super) fn of_memory(bytes: Vec<u8>) -> Self {
        Self {
            length: bytes.len() as u64,
            store: Store::Memory(bytes.into()),
        }
    }

    pub(super) fn length(&self) -> u64 {
        self.length
    }

    /// Returns `length` bytes that start at `offset`. If fewer bytes exist, returns `None` without
    /// allocating memory.
    pub(super) fn read(&self, offset: u64, length: u64) -> io::Result<Option<Vec<u8>>> {
        let end = offset.checked_add(length);
        if end.is_none_or(|end| end > self.length) {
            return Ok(None);
        }
        match &self.store {
            Store::Memory(bytes) => {
                // The numbers do not exceed the number of bytes in memory, so the casts are exact.
                let (start, length) = (offset as usize, length as usize);
                Ok(Some(bytes[start..start + length].to_vec()))
            }
            Store::File(file) => {
                let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
                file.seek(SeekFrom::Start(offset))?;
                let mut bytes = Vec::new();
                // Another process may have truncated the file. The buffer grows only with the data
                // that is read.
                (&mut *file).take(length).read_to_end(&mut bytes)?;
                Ok((bytes.len() as u64 == length).then_some(bytes))
            }
        }
    }
}
