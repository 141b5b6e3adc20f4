//! Viewers of a dashboard: `live viewers ADDRESS`. Ten read and acknowledge all frames, like a
//! page. One never reads, and connects again whenever the server disconnects it.

use std::io::Read as _;
use std::net::{SocketAddr, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use std::time::Duration;

use tungstenite::client::IntoClientRequest as _;
use tungstenite::{Message, WebSocket};

/// Number of viewers that read.
pub(crate) const VIEWERS: usize = 10;

/// Printed once all viewers have received a frame.
pub(crate) const READY: &str = "ready";

/// Runs until the standard input ends, and then prints the number of frames that were read since
/// all had one.
pub(crate) fn run(address: SocketAddr) -> anyhow::Result<()> {
    let counts: [AtomicU64; VIEWERS] = Default::default();
    let end = AtomicBool::new(false);
    thread::scope(|scope| {
        let viewers: Vec<_> = counts
            .iter()
            .map(|count| scope.spawn(|| read_all(address, count, &end)))
            .collect();
        scope.spawn(|| never_read(address, &end));
        let some = |count: &AtomicU64| count.load(Ordering::Relaxed) > 0;
        while !counts.iter().all(some) {
            if viewers.iter().any(thread::ScopedJoinHandle::is_finished) {
                break;
            }
            thread::sleep(Duration::from_millis(10));
        }
        println!("{READY}");
        let sum = || counts.iter().map(|it| it.load(Ordering::Relaxed)).sum();
        let before: u64 = sum();
        let ended = std::io::stdin().read_to_end(&mut Vec::new());
        println!("{}", sum() - before);
        end.store(true, Ordering::Relaxed);
        ended?;
        for viewer in viewers {
            viewer.join().expect("no panic")?;
        }
        Ok(())
    })
}

fn connect(address: SocketAddr) -> anyhow::Result<WebSocket<TcpStream>> {
    let stream = TcpStream::connect(address)?;
    let request = format!("ws://{address}/ws").into_client_request()?;
    let (socket, _) = tungstenite::client(request, stream)?;
    Ok(socket)
}

fn read_all(address: SocketAddr, count: &AtomicU64, end: &AtomicBool) -> anyhow::Result<()> {
    let mut socket = connect(address)?;
    while !end.load(Ordering::Relaxed) {
        if let Message::Binary(frame) = socket.read()?
            && let Some(time) = frame.get(8..16)
        {
            let time = u64::from_le_bytes(time.try_into()?);
            let seen = format!(r#"{{"type":"seen","server_ms":{time}}}"#);
            socket.send(Message::text(seen))?;
            count.fetch_add(1, Ordering::Relaxed);
        }
    }
    Ok(())
}

/// Sends refused requests 20 times per second, and reads no answer.
fn never_read(address: SocketAddr, end: &AtomicBool) {
    while !end.load(Ordering::Relaxed) {
        let Ok(mut socket) = connect(address) else {
            return;
        };
        while socket.send(Message::text(r#"{"type":"end"}"#)).is_ok() {
            thread::sleep(Duration::from_millis(50));
            if end.load(Ordering::Relaxed) {
                return;
            }
        }
    }
}
