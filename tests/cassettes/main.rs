//! Wire cassettes: a tap's recordings of sessions with the simulator, played back to the same
//! client. The same as captures of the network, and with Wireshark's dissector.

mod damaged;
mod dissector;
mod latency;
mod playing;
mod recorded;
mod tables;
