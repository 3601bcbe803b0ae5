//! The SCPI instruments of the rig: each with the profile that says how to talk to it, and the link that leads to it.

use super::fault::Fault;
use super::settings::{InstrumentSettings, LineSettings};
use super::wiring::Wiring;
use scpi::{LinkAddress, Profile, Transport};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Instrument profiles by name.
pub type Profiles = BTreeMap<String, Arc<Profile>>;

/// Handle of an instrument of the rig: index into [`Wiring::instruments`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Instrument(u16);

impl Instrument {
    /// Makes the handle of the instrument at an index of the wiring.
    pub(crate) fn at(index: usize) -> Self {
        assert!(
            index < usize::from(u16::MAX),
            "more instruments than an index can count"
        );
        Self(index as u16)
    }

    /// Returns the index in [`Wiring::instruments`].
    pub fn index(self) -> usize {
        self.0.into()
    }
}

/// One SCPI instrument.
#[derive(Debug, Clone)]
pub struct InstrumentWiring {
    /// Name in `config/rig.toml`.
    pub name: String,
    /// What the instrument is, and the commands of its programs.
    pub profile: Arc<Profile>,
    /// Where the instrument is.
    pub link: LinkAddress,
}

impl Wiring {
    /// Returns the instrument with this name; `None` when the rig lacks it.
    pub fn instrument_named(&self, name: &str) -> Option<Instrument> {
        let known = self.instruments.iter().position(|it| it.name == name);
        known.map(Instrument::at)
    }

    /// Returns the instrument with this handle.
    pub fn instrument(&self, instrument: Instrument) -> &InstrumentWiring {
        &self.instruments[instrument.index()]
    }

    /// Yields every instrument.
    pub fn instrument_ids(&self) -> impl Iterator<Item = Instrument> + use<> {
        (0..self.instruments.len()).map(Instrument::at)
    }
}

/// Makes the fault of an instrument whose profile no file has.
pub fn unknown_profile<'a>(
    instrument: &str,
    profile: &str,
    known: impl Iterator<Item = &'a str>,
) -> Fault {
    let known: Vec<&str> = known.collect();
    Fault::new(
        format!("instrument.{instrument}.profile"),
        format!("\"{profile}\""),
        format!("one of the profiles {}", known.join(", ")),
    )
}

/// Resolves profiles and links; no two instruments, and no instrument and line, share a port.
pub(super) fn resolve_instruments(
    instruments: &BTreeMap<String, InstrumentSettings>,
    lines: &BTreeMap<String, LineSettings>,
    profiles: &Profiles,
) -> Result<Vec<InstrumentWiring>, Fault> {
    let mut resolved: Vec<InstrumentWiring> = Vec::new();
    for (name, settings) in instruments {
        let profile = profiles.get(&settings.profile);
        let profile = profile.ok_or_else(|| {
            unknown_profile(name, &settings.profile, profiles.keys().map(String::as_str))
        })?;
        let key = format!("instrument.{name}.link");
        let found = format!("\"{}\"", settings.link);
        let link: LinkAddress = match settings.link.parse() {
            Ok(link) => link,
            Err(_) => return Err(Fault::new(key, found, LinkAddress::FORMS)),
        };
        if let Some(other) = resolved
            .iter()
            .find(|it| shares_port(&it.link.transport, &link.transport))
        {
            let expected = match link.gpib {
                Some(_) => "an adapter of its own",
                None => "a link of its own",
            };
            let other = format!("instrument.{}.link", other.name);
            return Err(Fault::new(key, found, expected).against(other));
        }
        if let Transport::Serial { path, .. } = &link.transport
            && let Some((line, _)) = lines.iter().find(|(_, line)| line.port == *path)
        {
            let other = format!("line.{line}.port");
            return Err(Fault::new(key, found, "a port that no line has").against(other));
        }
        resolved.push(InstrumentWiring {
            name: name.clone(),
            profile: Arc::clone(profile),
            link,
        });
    }
    Ok(resolved)
}

/// Returns true when both use the same TCP port or serial port; the baud rate does not matter.
fn shares_port(one: &Transport, other: &Transport) -> bool {
    match (one, other) {
        (Transport::Serial { path: one, .. }, Transport::Serial { path: other, .. }) => {
            one == other
        }
        (Transport::Serial { .. } | Transport::Tcp { .. }, _) => one == other,
    }
}
