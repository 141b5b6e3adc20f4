//! Checks of the route to the robot.

use franka_proto::RobotState;

use super::Check;
use crate::finding::{Group, Judged, Matters, Needs};
use crate::host::Unread;
use crate::readings::{NET, Readings};

/// Fields that the checks of the route and of the network card share.
pub(super) const NETWORK: Check = Check {
    id: "",
    group: Group::NetworkCard,
    matters: Matters::Reading,
    wanted: "",
    why: "",
    source: "",
    reads_only: true,
    of_card: true,
    judge: route,
};

pub(super) const CHECKS: &[Check] = &[
    Check {
        id: "nic.route",
        wanted: "a direct cable to the LAN port of Control, and an own address in the robot's /24 \
            network",
        why: "Routers and switches add delay and lose packets under load.",
        source: "vendor: FCI documentation, network: 172.16.0.1 and 172.16.0.2, not the Arm's port, no switch",
        of_card: false,
        judge: route,
        ..NETWORK
    },
    Check {
        id: "nic.kind",
        wanted: "Ethernet on PCI or on the board",
        why: "Wireless loses packets; USB polls; bridges and tunnels delay.",
        source: "vendor: cable required; USB: reports both ways in libfranka issue 131",
        judge: kind,
        ..NETWORK
    },
    Check {
        id: "nic.mtu",
        wanted: "1500",
        why: "With a smaller MTU, more datagrams are split, and one lost fragment loses the state.",
        source: "size of states: FCI protocol; an FER's come in two fragments at 1500",
        judge: mtu,
        ..NETWORK
    },
    Check {
        id: "nic.nm",
        wanted: "an address set by hand",
        why: "A temporary address (DHCP) expires or changes; a robot assigns no addresses.",
        source: "vendor: FCI documentation, network: static addresses on both sides",
        judge: lease,
        ..NETWORK
    },
    Check {
        id: "nic.two_robots",
        wanted: "one interface in the robot's network",
        why: "With two interfaces, answers may leave by the wrong cable.",
        source: "general knowledge of routing",
        judge: two_robots,
        ..NETWORK
    },
    Check {
        id: "net.busy_poll",
        wanted: "any",
        why: "The driver's option busy_poll sets it for the driver's own socket.",
        source: "general knowledge of Linux kernels",
        matters: Matters::Moving,
        of_card: false,
        judge: busy_poll,
        ..NETWORK
    },
];

fn route(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let robot = match readings.robot {
        Some(robot) => robot,
        None => return Err(Unread::Absent("the robot's IPv4 address".into())),
    };
    let route = match readings.route() {
        Ok(route) => route,
        // The system reports an error if it has no route to the robot.
        Err(Unread::Failed(_, why)) => return Ok(Judged::failure(format!("no route: {why}"))),
        Err(unread) => return Err(unread),
    };
    let read = format!("by {} from {}", route.interface, route.own);
    let near = u32::from(robot) >> 8 == u32::from(route.own) >> 8;
    Ok(match route.gateway {
        _ if route.interface == "lo" => Judged::info(format!("{read}: on this computer")),
        Some(_) => Judged::warning(format!("{read}, through a router")),
        None if near => Judged::good(format!("{read}, directly")),
        None => Judged::warning(format!("{read}, directly, not in the robot's /24")),
    })
}

fn kind(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let card = readings.interface()?;
    let path = format!("{NET}/{card}");
    let is = |name: &str| readings.host.list(&format!("{path}/{name}")).is_ok();
    let target = readings.host.link(&path)?;
    readings.note(path.as_str(), target.as_str());
    let has_file = |name: &str| readings.host.read(&format!("{path}/{name}")).is_ok();
    Ok(if is("wireless") || is("phy80211") {
        Judged::failure(format!("{card} is wireless"))
    } else if target.contains("/usb") {
        Judged::warning(format!("{card} is on USB"))
    } else if is("bridge") || is("brport") || is("bonding") {
        Judged::warning(format!("{card} is a bridge or a bond, or part of one"))
    } else if has_file("tun_flags") || card.starts_with("wg") {
        Judged::warning(format!("{card} is a tunnel"))
    } else if target.contains("/virtual/") {
        Judged::warning(format!("{card} is a virtual interface"))
    } else if target.contains("/virtio") {
        Judged::warning(format!("{card} is a card of a virtual machine"))
    } else if target.contains("/pci") || target.contains("/platform/") {
        Judged::good(format!("{card} is a card of this computer"))
    } else {
        Judged::info(format!("{card}: {target}"))
    })
}

fn lease(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let card = readings.interface()?;
    let own = readings.route()?.own;
    let lasting = readings.host.is_lasting(&card, own)?;
    readings.note("the own address is lasting", lasting.to_string());
    Ok(match lasting {
        true => Judged::good(format!("{card} has the static address {own}")),
        false => Judged::info(format!(
            "{card} has the temporary address {own}, as from DHCP"
        )),
    })
}

fn mtu(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let card = readings.interface()?;
    let mtu: u32 = readings.number(&format!("{NET}/{card}/mtu"))?;
    // Headers of IP and UDP have 20 and 8 bytes. All fragments except the last have a multiple of 8
    // bytes.
    let bytes = RobotState::MAX_SIZE as u32 + 8;
    let packets = match mtu.saturating_sub(20) {
        room if room >= bytes => 1,
        room => bytes.div_ceil((room / 8 * 8).max(8)),
    };
    let read = format!("{mtu}: the longest state comes in {packets} packets");
    Ok(match mtu {
        1500 => Judged::good(read),
        ..1500 => Judged::warning(read),
        _ => Judged::info(read),
    }
    .fix(Needs::Nothing, format!("sudo ip link set {card} mtu 1500")))
}

fn two_robots(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let card = readings.interface()?;
    let others = readings.route()?.others;
    Ok(match others.is_empty() {
        true => Judged::good(format!("{card} only")),
        false => Judged::failure(format!("{card}, and {}", others.join(", "))),
    })
}

fn busy_poll(readings: &Readings<'_>) -> Result<Judged, Unread> {
    let us: u64 = readings.number("/proc/sys/net/core/busy_poll")?;
    Ok(Judged::info(format!("{us} us")))
}
