//! The rack: sockets that a person fills, each with a contact input, a place on the plan and a number in the
//! multiplexer; and the lists by which a person unloads them.

use super::bin::Bin;
use super::fault::Fault;
use super::point::{DigitalInput, Thermometer};
use super::settings::{RackSettings, RigSettings, SocketSettings};
use units::Celsius;

/// Name of the thermometer in the rack; the door stays locked while the rack is hot.
pub const THERMOMETER: &str = "rack_temperature";

/// A socket of the rack.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Socket {
    /// Number on the rack, from 1.
    pub number: u16,
    /// Input that is on while the contact of the part is closed.
    pub contact: DigitalInput,
    /// Number of the socket at the multiplexer.
    pub select: u8,
    /// Row on the plan of the rack, from 1.
    pub row: u8,
    /// Column on that plan, from 1.
    pub column: u8,
}

/// Sockets, lists and thermometer of a rack.
#[derive(Debug, Clone, PartialEq)]
pub struct Rack {
    sockets: Vec<Socket>,
    lists: Vec<Bin>,
    /// Thermometer in the rack; the door stays locked while the rack is hot.
    pub thermometer: Thermometer,
    /// Temperature of the rack below which the door may be unlocked.
    pub unlock_below: Celsius,
}

impl Rack {
    /// Returns the sockets in the order of their numbers.
    pub fn sockets(&self) -> &[Socket] {
        &self.sockets
    }

    /// Returns the unloading lists, in the order in which a person unloads them.
    pub fn lists(&self) -> &[Bin] {
        &self.lists
    }

    /// Returns the socket with this number; `None` when the rack has none.
    pub fn socket(&self, number: u16) -> Option<&Socket> {
        self.sockets.iter().find(|it| it.number == number)
    }

    pub(super) fn resolve(
        rack: &RackSettings,
        settings: &RigSettings,
        thermometer: Thermometer,
        contact: impl Fn(&str) -> DigitalInput,
    ) -> Result<Self, Fault> {
        let mut named: Vec<(&str, Socket)> = Vec::new();
        for (name, socket) in &settings.socket {
            let one = (name.as_str(), resolve_socket(name, socket, contact(name))?);
            if let Some(fault) = named.iter().find_map(|it| clash(&one, it)) {
                return Err(fault);
            }
            named.push(one);
        }
        if named.is_empty() {
            return Err(Fault::new("socket", "no socket", "at least one"));
        }
        let mut sockets: Vec<Socket> = named.into_iter().map(|it| it.1).collect();
        sockets.sort_by_key(|it| it.number);
        Ok(Self {
            sockets,
            lists: resolve_lists(&rack.lists)?,
            thermometer,
            unlock_below: Celsius(rack.unlock_below_c),
        })
    }
}

/// Returns the name of the contact of a socket among the digital inputs.
pub(super) fn contact_name(socket: &str) -> String {
    format!("socket_{socket}")
}

fn resolve_socket(
    name: &str,
    settings: &SocketSettings,
    contact: DigitalInput,
) -> Result<Socket, Fault> {
    let number = name.parse().ok().filter(|it| (1..=999).contains(it));
    let Some(number) = number else {
        let expected = "the number of a socket, 1 to 999";
        return Err(Fault::new(
            format!("socket.{name}"),
            format!("the name \"{name}\""),
            expected,
        ));
    };
    let SocketSettings {
        select,
        row,
        column,
        ..
    } = *settings;
    Ok(Socket {
        number,
        contact,
        select,
        row,
        column,
    })
}

/// Returns the fault of a socket that has the same number, place on the plan or number at the multiplexer as an earlier
/// one.
fn clash((name, socket): &(&str, Socket), (before, other): &(&str, Socket)) -> Option<Fault> {
    let place = |it: &Socket| (it.row, it.column);
    let (key, found, expected) = if socket.number == other.number {
        ("", socket.number.to_string(), "a number of its own")
    } else if socket.select == other.select {
        (".select", socket.select.to_string(), "a number of its own")
    } else if place(socket) == place(other) {
        (".column", socket.column.to_string(), "a place of its own")
    } else {
        return None;
    };
    let fault = Fault::new(format!("socket.{name}{key}"), found, expected);
    Some(fault.against(format!("socket.{before}{key}")))
}

fn resolve_lists(names: &[String]) -> Result<Vec<Bin>, Fault> {
    let mut lists: Vec<Bin> = Vec::new();
    for (index, name) in names.iter().enumerate() {
        let key = format!("rack.lists.{index}");
        let found = format!("\"{name}\"");
        let Some(list) = Bin::from_name(name) else {
            let expected = format!(
                "a name of at most {} characters: a to z, 0 to 9 and _",
                Bin::LONGEST
            );
            return Err(Fault::new(key, found, expected));
        };
        if lists.contains(&list) {
            return Err(Fault::new(key, found, "a list of its own"));
        }
        lists.push(list);
    }
    for needed in [Bin::PASS, Bin::RETEST] {
        if !lists.contains(&needed) {
            let expected = format!("the list \"{needed}\" among them");
            return Err(Fault::new("rack.lists", names.join(", "), expected));
        }
    }
    Ok(lists)
}
