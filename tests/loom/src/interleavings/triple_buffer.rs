//! The triple buffer.

use loom::thread;

use crate::triple_buffer::{Reader, triple_buffer};

/// The `n`th value; no mix of two values looks like one.
fn value(n: u64) -> [u64; 2] {
    [n, 100 + n]
}

/// Reads once and checks that the value is whole and newer than `newest`.
fn read(reader: &mut Reader<[u64; 2]>, newest: u64) -> u64 {
    reader.read_newer().map_or(newest, |read| {
        assert_eq!(read, value(read[0]), "a mix of two values");
        assert!(read[0] > newest, "{} after {newest}", read[0]);
        read[0]
    })
}

#[test]
fn values_are_whole_never_go_back_and_the_newest_arrives() {
    loom::model(|| {
        let (mut writer, mut reader) = triple_buffer();
        let writing = thread::spawn(move || {
            for n in 1..=3 {
                writer.write(value(n));
            }
        });
        let newest = read(&mut reader, 0);
        let newest = read(&mut reader, newest);
        writing.join().expect("the writer does not panic");
        assert_eq!(read(&mut reader, newest), 3, "the newest value");
        assert_eq!(reader.read_newer(), None);
    });
}

#[test]
fn a_write_under_way_keeps_no_reader_from_a_value() {
    loom::model(|| {
        let (mut writer, mut reader) = triple_buffer();
        writer.write(value(1));
        let writing = thread::spawn(move || writer.write(value(2)));
        assert_ne!(read(&mut reader, 0), 0, "a whole value");
        writing.join().expect("the writer does not panic");
    });
}
