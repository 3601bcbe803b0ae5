//! Instruments of a rig: names and links from `rig.toml`, models and terminals from the world file.
//!
//! A link in `rig.toml` is `tcp:HOST:PORT`, `serial:PATH:BAUD`, `gpib-tcp:HOST:PORT:ADDRESS` or
//! `gpib-serial:PATH:BAUD:ADDRESS`. The simulated rig takes its kind, rate and address, and opens a place of its own.
//! Instruments whose GPIB links have the same place share one adapter, which has the name of that place.

use std::collections::BTreeMap;

use super::adapter::Adapter;
use super::bench::Instruments;
use super::device::Device;
use super::file::{Link, fitting};
use super::instrument;
use super::port::{Behind, Port};
use crate::config::{ConfigError, Files};
use crate::fault::instrument::InstrumentFaults;
use crate::table::Table;
use crate::world::table::present;

/// Form of a link.
const FORM: &str =
    "tcp:HOST:PORT, serial:PATH:BAUD, gpib-tcp:HOST:PORT:ADDRESS or gpib-serial:PATH:BAUD:ADDRESS";

/// A link of `rig.toml`.
struct Place {
    link: Link,
    /// Place of the adapter and primary address of the instrument behind it.
    gpib: Option<(String, u8)>,
}

/// Builds the instruments that `rig.toml` lists; `models` is the table `[instrument]` of the world file. Returns `None`
/// for a rig without instruments.
///
/// # Errors
/// Fails when a link has an unknown form, two instruments have one address, or an instrument has no model.
pub fn build(
    rig: &BTreeMap<String, Table>,
    models: &Option<BTreeMap<String, Table>>,
    files: &Files,
    seed: u64,
) -> Result<Option<Instruments>, ConfigError> {
    if rig.is_empty() {
        return Ok(None);
    }
    let models = present(models, "instrument", files)?;
    let (mut devices, mut ports): (Vec<Device>, Vec<Port>) = Default::default();
    let mut adapters: BTreeMap<String, (Link, Adapter)> = BTreeMap::new();
    for (name, keys) in rig {
        let (number, place) = (devices.len(), place(keys)?);
        match place.gpib {
            None => ports.push(Port::new(
                name.clone(),
                place.link,
                Behind::Instrument(number),
            )),
            Some((at, address)) => {
                let new = || (place.link, Adapter::new(&at));
                let (_, adapter) = adapters.entry(at.clone()).or_insert_with(new);
                if adapter.instruments.insert(address, number).is_some() {
                    return Err(keys.wrong("link", "an address that no other instrument has"));
                }
            }
        }
        let missing = || present::<Table>(&None, &format!("instrument.{name}"), files);
        let fitted = models.get(name).cloned().map_or_else(missing, Ok)?;
        let model = fitted.get("model")?;
        let instrument = instrument::build(model, name, seed, fitting(&fitted, model)?);
        fitted.finish()?;
        devices.push(Device::new(name.clone(), instrument));
    }
    let behind_adapters = adapters
        .into_iter()
        .map(|(at, (link, adapter))| Port::new(at, link, Behind::Adapter(adapter)));
    ports.extend(behind_adapters);
    let faults = InstrumentFaults::none(seed);
    Ok(Some(Instruments {
        devices,
        ports,
        faults,
    }))
}

fn place(keys: &Table) -> Result<Place, ConfigError> {
    let text: String = keys.get("link")?;
    parsed(&text).ok_or_else(|| keys.wrong("link", FORM))
}

/// Takes a link apart; `None` for another form.
fn parsed(text: &str) -> Option<Place> {
    let (kind, rest) = text.split_once(':')?;
    let (place, address) = match kind.starts_with("gpib-") {
        true => {
            let (place, address) = rest.rsplit_once(':')?;
            let address = address.parse().ok().filter(|it: &u8| *it <= 30)?;
            (place, Some(address))
        }
        false => (rest, None),
    };
    let (_, number) = place.rsplit_once(':')?;
    let link = match kind {
        "tcp" | "gpib-tcp" => {
            let _: u16 = number.parse().ok()?;
            Link::Tcp(0)
        }
        "serial" | "gpib-serial" => Link::Serial(number.parse().ok().filter(|baud| *baud > 0)?),
        _ => return None,
    };
    Some(Place {
        link,
        gpib: address.map(|address| (place.to_owned(), address)),
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_link_has_kind_rate_and_address() {
        let lan = parsed("tcp:192.168.10.11:5025").unwrap();
        assert_eq!((lan.link, lan.gpib), (Link::Tcp(0), None));
        let serial = parsed("serial:/dev/ttyUSB3:115200").unwrap();
        assert_eq!((serial.link, serial.gpib), (Link::Serial(115_200), None));
        let gpib = parsed("gpib-tcp:10.0.0.2:1234:9").unwrap();
        let expected = (Link::Tcp(0), Some(("10.0.0.2:1234".to_owned(), 9)));
        assert_eq!((gpib.link, gpib.gpib), expected);
        for wrong in [
            "tcp:5025",
            "usb:1:2",
            "gpib-tcp:10.0.0.2:1234:31",
            "serial:/dev/x:0",
        ] {
            assert!(parsed(wrong).is_none(), "{wrong}");
        }
    }
}
