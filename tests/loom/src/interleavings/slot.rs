//! The slot.

use loom::thread;

use crate::slot::{Read, SlotReader, slot};

/// The two words of the `n`th value; no mix of two values looks like one.
fn value(n: u64) -> [u64; 2] {
    [n, 100 + n]
}

/// Reads once and checks that the value is whole and newer than `newest`.
fn read(reader: &mut SlotReader<[u64; 2]>, newest: u64) -> u64 {
    match reader.read_newer() {
        Read::Newer(words) => {
            assert_eq!(words, value(words[0]), "a mix of two values");
            assert!(words[0] > newest, "{} after {newest}", words[0]);
            words[0]
        }
        Read::Same | Read::Torn => newest,
    }
}

#[test]
fn a_torn_value_never_surfaces_and_values_never_go_back() {
    loom::model(|| {
        let (mut writer, mut reader) = slot::<[u64; 2]>();
        let writing = thread::spawn(move || {
            // The third value replaces the first.
            for n in 1..=3 {
                writer.write(&value(n));
            }
        });
        let newest = read(&mut reader, 0);
        let newest = read(&mut reader, newest);
        writing.join().expect("the writer does not panic");
        if newest < 3 {
            assert_eq!(
                reader.read_newer(),
                Read::Newer(value(3)),
                "after the last write the newest value is there"
            );
        }
        assert_eq!(reader.read_newer(), Read::Same);
    });
}

/// A writer that is delayed anywhere in one write leaves a whole value.
#[test]
fn a_write_under_way_keeps_no_reader_from_a_value() {
    loom::model(|| {
        let (mut writer, mut reader) = slot::<[u64; 2]>();
        writer.write(&value(1));
        let writing = thread::spawn(move || writer.write(&value(2)));
        assert_ne!(read(&mut reader, 0), 0, "a whole value");
        writing.join().expect("the writer does not panic");
    });
}

#[test]
fn two_readers_do_not_disturb_each_other() {
    loom::model(|| {
        let (mut writer, mut first) = slot::<[u64; 2]>();
        let mut second = first.clone();
        let reading = thread::spawn(move || read(&mut second, 0));
        let writing = thread::spawn(move || writer.write(&value(1)));
        read(&mut first, 0);
        reading.join().expect("the reader does not panic");
        writing.join().expect("the writer does not panic");
    });
}
