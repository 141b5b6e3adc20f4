//! The services at the robot's address.

use core::time::Duration;
use std::io;
use std::net::{IpAddr, SocketAddr, TcpStream};

use crate::finding::{About, Finding, Judged, Needs, Purpose};

/// Connects to the ports of the robot and its end effectors, and closes the connections
/// immediately. Each connection has a time limit of a second. The function sends no request. The
/// caller must ensure that no program controls the robot.
pub fn ports(robot: IpAddr, purpose: Purpose) -> Vec<Finding> {
    PORTS
        .map(|port| {
            let address = SocketAddr::new(robot, port.number);
            port.finding(
                TcpStream::connect_timeout(&address, TIMEOUT).map(drop),
                purpose,
            )
        })
        .into()
}

struct Port {
    id: &'static str,
    number: u16,
    what: &'static str,
    /// True if every robot has this service.
    always: bool,
}

const PORTS: [Port; 3] = [
    Port {
        id: "robot.tcp",
        number: 1337,
        what: "the robot",
        always: true,
    },
    Port {
        id: "robot.tcp.hand",
        number: 1338,
        what: "a Franka Hand",
        always: false,
    },
    Port {
        id: "robot.tcp.vacuum",
        number: 1339,
        what: "a vacuum gripper",
        always: false,
    },
];

impl Port {
    fn finding(&self, connected: io::Result<()>, purpose: Purpose) -> Finding {
        let (what, number) = (self.what, self.number);
        let judged = match connected {
            Ok(()) => Judged::good(format!("{what} answers on port {number}")),
            Err(error) if error.kind() == io::ErrorKind::ConnectionRefused && self.always => {
                Judged::failure(format!(
                    "port {number} refuses connections: FCI is not active or not installed \
                     (Connection to FCI refused. Please install FCI feature or enable FCI mode in \
                     Desk.)"
                ))
            }
            Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => {
                Judged::info(format!("port {number} refuses connections: {what} is missing or not \
                    active"))
            }
            Err(error) if self.always => Judged::failure(format!(
                "port {number}: {error}: wrong address, cable unplugged, or a firewall (Connection timeout. Please check your network connection or settings.)"
            ))
            .fix(Needs::Nothing, "ip -brief address && ip route"),
            Err(error) => Judged::info(format!("port {number}: {error}")),
        };
        let about = About::robot(
            self.id,
            match self.always {
                true => "open within 1 s",
                false => "open within 1 s, if this end effector is mounted",
            },
            "Commands use this connection, which is open while FCI is active.",
            "vendor: FCI documentation and the texts of libfranka",
        );
        about.finding(Ok(judged), purpose)
    }
}

const TIMEOUT: Duration = Duration::from_secs(1);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finding::Verdict;

    #[test]
    fn closed_port_has_a_reason_and_end_effector_is_optional() {
        let find = |port: &Port, kind: io::ErrorKind| port.finding(Err(kind.into()), Purpose::Move);
        let [robot, hand, _] = &PORTS;
        let refused = find(robot, io::ErrorKind::ConnectionRefused);
        assert_eq!(refused.verdict, Verdict::Failure);
        assert!(
            refused.read.contains("FCI is not active"),
            "{}",
            refused.read
        );
        let silent = find(robot, io::ErrorKind::TimedOut);
        assert_eq!(silent.verdict, Verdict::Failure);
        assert!(silent.read.contains("cable"), "{}", silent.read);
        assert_eq!(find(hand, io::ErrorKind::TimedOut).verdict, Verdict::Info);
        assert_eq!(robot.finding(Ok(()), Purpose::Read).verdict, Verdict::Good);
    }
}
