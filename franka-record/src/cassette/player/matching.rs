//! Compares a client's messages with the recorded messages.

use super::{Matching, Mismatch, Player, Step, counter};

impl Player {
    pub(super) fn on_request(&mut self, message: &[u8]) -> Result<(), Mismatch> {
        let device = self.script.device;
        let Some(step) = self.next_request() else {
            let got = self.script.describe(&Step::Request(message.to_vec()));
            return self.fail(got, "no more requests".to_owned());
        };
        let Step::Request(recorded) = &self.script.steps[step].1 else {
            unreachable!("next_request returns requests");
        };
        let connect = self.udp_port.is_none();
        if let Some(got) = self.difference(recorded, message, connect) {
            let expected = self.expected(step);
            return self.fail(got, expected);
        }
        let range = device.id_range();
        let (mut from, mut to) = ([0; 4], [0; 4]);
        from.copy_from_slice(&recorded[range.clone()]);
        to.copy_from_slice(&message[range]);
        self.ids.insert(from, to);
        if connect {
            let request = device.connect(message);
            self.udp_port = request.map(|request| request.udp_port.get());
        }
        self.requested = step + 1;
        self.tally.requests += 1;
        Ok(())
    }

    /// Returns the difference between a message and the recorded message; `None` if the difference
    /// does not matter.
    fn difference(&self, recorded: &[u8], got: &[u8], connect: bool) -> Option<String> {
        let device = self.script.device;
        let name = self.script.describe(&Step::Request(got.to_vec()));
        let command = device.id_range().start;
        let payload = device.id_range().end + 4;
        if recorded[..command] != got[..command] {
            return Some(name);
        }
        // The version in a handshake determines all later messages. The port follows the version.
        let (start, end) = match (connect, self.options.matching) {
            (true, _) => (payload, payload + 2),
            (false, Matching::Strict) => (payload, recorded.len().max(got.len())),
            (false, Matching::Lenient) => return None,
        };
        let differs = (start..end).find(|&i| recorded.get(i) != got.get(i))?;
        let byte = |bytes: &[u8]| match bytes.get(differs) {
            Some(byte) => format!("{byte:#04x}"),
            None => "missing".to_owned(),
        };
        Some(format!(
            "{name} with other parameters (byte {differs} of the message is {}, recorded {})",
            byte(got),
            byte(recorded)
        ))
    }

    pub(super) fn compare_command(&mut self, id: Option<u64>, got: &[u8]) -> Result<(), Mismatch> {
        let size = self.script.device.counter_size();
        let name = match id {
            Some(id) => format!("a command for state {id}"),
            None => self.script.describe(&Step::Command(got.to_vec())),
        };
        let Some(step) = self.next_command() else {
            return self.fail(name, "no more commands".to_owned());
        };
        let Step::Command(recorded) = &self.script.steps[step].1 else {
            unreachable!("next_command returns commands");
        };
        if id.is_some() && counter(self.script.device, recorded) != id {
            let expected = self.expected(step);
            return self.fail(name, expected);
        }
        if recorded.get(size..) != got.get(size..) {
            let pairs = recorded.iter().zip(got).skip(size);
            let differs = size + pairs.take_while(|(one, other)| one == other).count();
            let expected = self.expected(step);
            return self.fail(
                format!(
                    "{name} of {} bytes that differs from byte {differs} on",
                    got.len()
                ),
                format!("{expected} of {} bytes", recorded.len()),
            );
        }
        self.commanded = step + 1;
        Ok(())
    }

    /// Accepts a command. The command replaces all recorded commands up to the state that it
    /// answers. A command that ends a motion also replaces all other commands of this motion.
    pub(super) fn accept_command(&mut self, id: Option<u64>, got: &[u8]) {
        let finishes = self.script.finishes(got);
        while let Some(step) = self.next_command() {
            let Step::Command(recorded) = &self.script.steps[step].1 else {
                unreachable!("next_command returns commands");
            };
            let last = self.script.finishes(recorded);
            let covered = counter(self.script.device, recorded) <= id;
            if !finishes && (last || !covered) {
                return;
            }
            self.commanded = step + 1;
            if last {
                return;
            }
        }
    }
}
