#![no_main]

use franka_record::cassette::{Cassette, Pace, PlayOptions, Player, pcap};
use std::time::Duration;

// A cassette, or a capture of the network: read, written again the same, and played as far as it
// goes.
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let cassette = Cassette::read(bytes).ok();
    for cassette in cassette.into_iter().chain(pcap::from_capture(bytes)) {
        let file = cassette.to_bytes().expect("few channels");
        let again = Cassette::read(&file).expect("just written");
        assert_eq!(again.connections.len(), cassette.connections.len());
        for (again, connection) in again.connections.iter().zip(&cassette.connections) {
            assert_eq!(again.device, connection.device);
            assert_eq!(again.events.len(), connection.events.len());
            assert_eq!(again.missing_stream, connection.missing_stream);
            assert_eq!(again.missing_datagrams, connection.missing_datagrams);
        }
        for connection in &cassette.connections {
            let mut options = PlayOptions::default();
            options.pace = Pace::Lockstep;
            if let Ok(mut player) = Player::new(connection, options, Duration::ZERO) {
                while let Ok(Some(_)) = player.poll(Duration::ZERO) {}
            }
        }
    }
});
