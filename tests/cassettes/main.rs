//! Wire cassettes: what a tap records of sessions with the simulator, played back to the same
//! client; the same as captures of the network, and before Wireshark's dissector.

mod damaged;
mod dissector;
mod latency;
mod playing;
mod recorded;
mod tables;
