//! Round-trip time of datagrams to another thread of this host. The measurement includes the
//! sockets of a control cycle, but no network card.

use core::time::Duration;
use std::io;
use std::net::{Ipv4Addr, UdpSocket};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use std::time::Instant;

use crate::latencies::Latencies;
use crate::round_trip::{PAYLOAD, PERIOD};

/// Sends `count` datagrams, at most one per millisecond, to a thread that returns each datagram.
/// That thread has the same scheduling as the calling thread. `priority` is stored in the result.
/// `done` counts the returned datagrams.
pub(crate) fn measure(
    priority: Option<i32>,
    count: u64,
    done: &AtomicU64,
) -> io::Result<Latencies> {
    let [here, there] = sockets()?;
    let over = AtomicBool::new(false);
    thread::scope(|scope| {
        // The thread inherits the scheduling of the calling thread.
        let echoing = thread::Builder::new().spawn_scoped(scope, || echo(&there, &over))?;
        let measured = exchange(&here, priority, count, done);
        over.store(true, Ordering::Relaxed);
        echoing.join().expect("an echo does not panic")?;
        measured
    })
}

/// Returns two sockets of this host that are connected to each other.
fn sockets() -> io::Result<[UdpSocket; 2]> {
    let [here, there] = [(); 2].map(|()| UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)));
    let (here, there) = (here?, there?);
    here.connect(there.local_addr()?)?;
    there.connect(here.local_addr()?)?;
    here.set_read_timeout(Some(PATIENCE))?;
    // At this interval, the thread checks whether it must end.
    there.set_read_timeout(Some(Duration::from_millis(100)))?;
    Ok([here, there])
}

fn exchange(
    socket: &UdpSocket,
    priority: Option<i32>,
    count: u64,
    done: &AtomicU64,
) -> io::Result<Latencies> {
    let mut latencies = Latencies::new(priority);
    let mut packet = [0; PAYLOAD];
    let mut due = Instant::now();
    for number in 0..count {
        thread::sleep(due.saturating_duration_since(Instant::now()));
        let sent = Instant::now();
        socket.send(&packet)?;
        while let Err(error) = socket.recv(&mut packet) {
            if error.kind() != io::ErrorKind::Interrupted {
                return Err(error);
            }
        }
        latencies.note(sent.elapsed());
        done.store(number + 1, Ordering::Relaxed);
        // Missed periods are not repeated.
        due = Instant::now().max(due + PERIOD);
    }
    Ok(latencies)
}

/// Returns each datagram to its sender, until `over` is true.
fn echo(socket: &UdpSocket, over: &AtomicBool) -> io::Result<()> {
    use io::ErrorKind::{Interrupted, TimedOut, WouldBlock};
    let mut packet = [0; PAYLOAD];
    while !over.load(Ordering::Relaxed) {
        match socket.recv(&mut packet) {
            Ok(length) => drop(socket.send(&packet[..length])?),
            Err(error) if matches!(error.kind(), Interrupted | TimedOut | WouldBlock) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

/// Time after which a datagram counts as missing.
const PATIENCE: Duration = Duration::from_secs(10);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_datagram_comes_back() {
        let done = AtomicU64::new(0);
        let latencies = measure(Some(7), 20, &done).expect("sockets of this host");
        assert_eq!((latencies.count(), done.into_inner()), (20, 20));
        assert_eq!(latencies.priority, Some(7));
        assert!(latencies.min() > Some(Duration::ZERO));
    }
}
