//! A viewer that never reads costs the server no memory, and the other viewers nothing. An
//! allocator counts what is in use, so this is the only test of its program.

#[path = "../sockets/viewer.rs"]
#[allow(dead_code, reason = "other programs use the rest")]
mod viewer;

use std::alloc::{GlobalAlloc, Layout, System};
use std::net::SocketAddr;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use socket2::{Domain, Socket, Type};
use tungstenite::Message;
use tungstenite::client::IntoClientRequest as _;

use viewer::{LONGEST, Served, Viewer};

/// Bytes in use, and the most that there have been since it was set.
static IN_USE: AtomicI64 = AtomicI64::new(0);
static MOST: AtomicI64 = AtomicI64::new(0);

struct Counting;

fn count(bytes: i64) {
    let now = IN_USE.fetch_add(bytes, Ordering::Relaxed) + bytes;
    MOST.fetch_max(now, Ordering::Relaxed);
}

// SAFETY: every method hands its arguments to the system's allocator unchanged and returns what
// that returns; counting is a change of atomics, which neither allocates nor fails.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as i64);
        // SAFETY: the caller's obligations are those of the system's allocator.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(-(layout.size() as i64));
        // SAFETY: as above; `pointer` came from the system's allocator.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// A connection that has room for little of what it does not read.
fn deaf(address: SocketAddr) -> tungstenite::WebSocket<std::net::TcpStream> {
    let socket = Socket::new(Domain::IPV4, Type::STREAM, None).expect("a socket");
    socket.set_recv_buffer_size(4096).expect("an option");
    socket.connect(&address.into()).expect("a connection");
    let request = format!("ws://{address}/ws");
    let request = request.into_client_request().expect("a request");
    let (socket, _) = tungstenite::client(request, socket.into()).expect("a socket");
    socket
}

/// Asks for what is refused at length, and reads no answer, until the server gives it up. Returns
/// the bytes of the answers to what was sent, about.
fn flood(address: SocketAddr) -> usize {
    let mut socket = deaf(address);
    let begin = Instant::now();
    // The answer repeats it.
    let request = format!(r#"{{"type":"{}"}}"#, "x".repeat(4000));
    let mut sent = 0;
    while socket.send(Message::text(request.as_str())).is_ok() {
        sent += request.len();
        assert!(begin.elapsed() < LONGEST, "the server goes on with it");
    }
    sent
}

#[test]
fn a_viewer_that_never_reads_costs_no_memory_and_the_others_nothing() {
    let served = Served::movable();
    let frames: [AtomicU64; OTHERS] = Default::default();
    let end = AtomicBool::new(false);
    let more = |begin: Instant| {
        let before = frames.each_ref().map(|it| it.load(Ordering::Relaxed));
        let each = || frames.iter().zip(before);
        while !each().all(|(now, before)| now.load(Ordering::Relaxed) >= before + 60) {
            assert!(begin.elapsed() < LONGEST, "a viewer gets no frames");
            thread::sleep(Duration::from_millis(10));
        }
    };
    thread::scope(|scope| {
        for count in &frames {
            let (end, address) = (&end, served.address);
            scope.spawn(move || {
                let mut viewer = Viewer::connect(address);
                while !end.load(Ordering::Relaxed) {
                    viewer.wait_for("frame");
                    count.fetch_add(1, Ordering::Relaxed);
                }
            });
        }
        more(Instant::now());
        // One that asks for nothing as well, and stays until it is given up.
        let silent = deaf(served.address);
        let before = IN_USE.load(Ordering::Relaxed);
        MOST.store(before, Ordering::Relaxed);
        let asked: usize = (0..FLOODS).map(|_| flood(served.address)).sum();
        more(Instant::now());
        let grown = MOST.load(Ordering::Relaxed) - before;
        println!("{asked} bytes were to be answered; {grown} bytes more in use at most");
        end.store(true, Ordering::Relaxed);
        drop(silent);
        assert!(grown < GROWTH_MAX, "{grown} bytes");
    });
}

/// Viewers that read.
const OTHERS: usize = 10;

/// Connections of one that does not.
const FLOODS: usize = 3;

/// Most that may be in use beside what was: replies and frames that wait, the buffers of the
/// flooding connection on both sides, and what threads of robot and viewers use for a moment.
const GROWTH_MAX: i64 = 1024 * 1024;
