//! The route to the robot, from the kernel's routing table.

use std::net::Ipv4Addr;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Route {
    pub(crate) interface: String,
    /// Router on the route; `None` for a direct route.
    pub(crate) gateway: Option<Ipv4Addr>,
    /// The host's own address on this route.
    pub(crate) own: Ipv4Addr,
    /// Other interfaces with a direct route to the same address.
    pub(crate) others: Vec<String>,
}

impl Route {
    /// Returns the route to an address of the host itself.
    pub(crate) fn own_host(own: Ipv4Addr) -> Self {
        Self {
            interface: "lo".into(),
            gateway: None,
            own,
            others: Vec::new(),
        }
    }

    /// Returns the route to `robot` from the text of `/proc/net/route`. The row with the longest
    /// mask has priority. Among equal masks, the row with the lowest metric has priority.
    pub(crate) fn find(table: &str, robot: Ipv4Addr, own: Ipv4Addr) -> Option<Self> {
        let mut rows: Vec<Row> = table
            .lines()
            .skip(1)
            .filter_map(Row::parse)
            .filter(|row| row.up && u32::from(robot) & row.mask == row.destination)
            .collect();
        rows.sort_by_key(|row| (u32::MAX - row.mask, row.metric));
        let best = rows.first()?;
        let direct = rows[1..]
            .iter()
            .filter(|row| row.gateway == 0 && row.mask != 0 && row.interface != best.interface);
        Some(Self {
            interface: best.interface.clone(),
            gateway: (best.gateway != 0).then(|| Ipv4Addr::from(best.gateway)),
            own,
            others: direct.map(|row| row.interface.clone()).collect(),
        })
    }
}

/// A row of the table, with addresses as numbers in the host's byte order.
struct Row {
    interface: String,
    destination: u32,
    gateway: u32,
    mask: u32,
    metric: u32,
    up: bool,
}

impl Row {
    fn parse(line: &str) -> Option<Self> {
        let words: Vec<&str> = line.split_whitespace().collect();
        // The kernel prints the bytes of an address as one number in the byte order of this
        // machine.
        let address = |word: &str| {
            let number = u32::from_str_radix(word, 16).ok()?;
            Some(u32::from_be_bytes(number.to_ne_bytes()))
        };
        let [
            interface,
            destination,
            gateway,
            flags,
            _,
            _,
            metric,
            mask,
            ..,
        ] = words[..]
        else {
            return None;
        };
        Some(Self {
            interface: interface.into(),
            destination: address(destination)?,
            gateway: address(gateway)?,
            mask: address(mask)?,
            metric: metric.parse().ok()?,
            up: u32::from_str_radix(flags, 16).ok()? & 1 != 0,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A routing table: a direct cable, a second card in the same network, and the office with a
    /// router.
    const TABLE: &str = "Iface Destination Gateway Flags RefCnt Use Metric Mask MTU Window IRTT
wlan0 00000000 0100A8C0 0003 0 0 600 00000000 0 0 0
eth1 000010AC 00000000 0001 0 0 100 00FFFFFF 0 0 0
eth0 000010AC 00000000 0001 0 0 50 00FFFFFF 0 0 0
wlan0 0000A8C0 00000000 0001 0 0 600 00FFFFFF 0 0 0
";

    #[test]
    fn the_longest_mask_and_then_the_least_metric_decide() {
        let own = Ipv4Addr::new(172, 16, 0, 1);
        let robot = Route::find(TABLE, Ipv4Addr::new(172, 16, 0, 2), own).expect("a way");
        assert_eq!((robot.interface.as_str(), robot.gateway), ("eth0", None));
        assert_eq!(robot.others, ["eth1"]);
        let far = Route::find(TABLE, Ipv4Addr::new(8, 8, 8, 8), own).expect("a way");
        let router = Ipv4Addr::new(192, 168, 0, 1);
        assert_eq!(
            (far.interface.as_str(), far.gateway),
            ("wlan0", Some(router))
        );
        assert_eq!(far.others, Vec::<String>::new());
        assert_eq!(Route::find("", own, own), None);
    }
}
