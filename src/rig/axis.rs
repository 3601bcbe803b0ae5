//! The point table of the sort axis: the nest, a place to park, and a bin at every other point.
//!
//! The slide knows eight points, chosen by three outputs; it goes there on a rising edge of
//! `axis_drive`. Positions are relative to the nest, along the line.

use super::fault::Fault;
use super::point::DigitalInput;
use super::settings::{BinSettings, StationSettings};
use std::collections::BTreeMap;

/// Where a part ends, by the cause of its rejection.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Bin {
    /// Good parts.
    Pass,
    /// Coil resistance out of limits.
    Coil,
    /// Operate or release voltage out of limits.
    Voltage,
    /// Times or bounce out of limits.
    Time,
    /// Contact resistance out of limits, stuck contact.
    Contact,
    /// Not judged.
    Retest,
}

impl Bin {
    /// Every bin, in the order of the line.
    pub const ALL: &'static [Self] = &[
        Self::Pass,
        Self::Coil,
        Self::Voltage,
        Self::Time,
        Self::Contact,
        Self::Retest,
    ];
    /// The names of [`Self::ALL`].
    pub const NAMES: &'static [&'static str] =
        &["pass", "coil", "voltage", "time", "contact", "retest"];

    /// The name used in files, rows and messages.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// The bin of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        let index = Self::NAMES.iter().position(|known| *known == name)?;
        Self::ALL.get(index).copied()
    }
}

/// A place of the sort axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum AxisStation {
    /// Over the nest.
    Nest,
    /// Out of the way of the nest.
    Park,
    /// Over the chute of a bin.
    Bin(Bin),
}

impl AxisStation {
    /// Its key in `config/rig.toml`: `axis.park`, `bin.pass`.
    pub fn key(self) -> String {
        match self {
            Self::Nest => "axis.nest".to_owned(),
            Self::Park => "axis.park".to_owned(),
            Self::Bin(bin) => format!("bin.{}", bin.name()),
        }
    }
}

/// A point of the slide's own table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisPoint {
    /// Number on the point bits, 0 to 7.
    pub number: u8,
    /// Position relative to the nest, mm.
    pub x_mm: f64,
}

/// The points of the sort axis and the beams in the chutes.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisTable {
    nest: AxisPoint,
    park: AxisPoint,
    bins: [(AxisPoint, DigitalInput); 6],
}

impl AxisTable {
    /// The point of a station.
    pub fn point(&self, station: AxisStation) -> AxisPoint {
        match station {
            AxisStation::Nest => self.nest,
            AxisStation::Park => self.park,
            AxisStation::Bin(bin) => self.bins[bin as usize].0,
        }
    }

    /// The beam in the chute of a bin.
    pub fn beam(&self, bin: Bin) -> DigitalInput {
        self.bins[bin as usize].1
    }

    /// The station at a position, within a micrometre; `None` between stations.
    pub fn station_at(&self, x_mm: f64) -> Option<AxisStation> {
        self.stations()
            .find(|station| (self.point(*station).x_mm - x_mm).abs() < 1e-3)
    }

    /// Every station.
    pub fn stations(&self) -> impl Iterator<Item = AxisStation> + use<> {
        let bins = Bin::ALL.iter().copied().map(AxisStation::Bin);
        [AxisStation::Nest, AxisStation::Park]
            .into_iter()
            .chain(bins)
    }

    pub(super) fn resolve(
        axis: &BTreeMap<String, StationSettings>,
        bins: &BTreeMap<String, BinSettings>,
        input: impl Fn(&str) -> Option<DigitalInput>,
    ) -> Result<Self, Fault> {
        let mut taken = Taken::default();
        let nest = taken.station("nest", axis)?;
        let park = taken.station("park", axis)?;
        let mut found = Vec::new();
        for &bin in Bin::ALL {
            found.push(taken.bin(bin, bins, &input)?);
        }
        let bins = <[(AxisPoint, DigitalInput); 6]>::try_from(found)
            .map_err(|found| Fault::new("bin", found.len(), "six bins"))?;
        Ok(Self { nest, park, bins })
    }
}

/// Numbers, positions and beams already given away, with the key that has them.
#[derive(Default)]
struct Taken {
    points: Vec<(AxisPoint, String)>,
    beams: Vec<(DigitalInput, String)>,
}

impl Taken {
    fn station(
        &mut self,
        name: &str,
        axis: &BTreeMap<String, StationSettings>,
    ) -> Result<AxisPoint, Fault> {
        let key = format!("axis.{name}");
        let Some(station) = axis.get(name) else {
            return Err(Fault::new(key, "nothing", "a point of the axis"));
        };
        self.point(
            key,
            AxisPoint {
                number: station.point,
                x_mm: station.x_mm,
            },
        )
    }

    fn bin(
        &mut self,
        bin: Bin,
        bins: &BTreeMap<String, BinSettings>,
        input: impl Fn(&str) -> Option<DigitalInput>,
    ) -> Result<(AxisPoint, DigitalInput), Fault> {
        let key = format!("bin.{}", bin.name());
        let Some(settings) = bins.get(bin.name()) else {
            return Err(Fault::new(key, "nothing", "a bin"));
        };
        let point = self.point(
            key.clone(),
            AxisPoint {
                number: settings.point,
                x_mm: settings.x_mm,
            },
        )?;
        let name = &settings.beam;
        let beam = self.beam(format!("{key}.beam"), name, input(name))?;
        Ok((point, beam))
    }

    fn point(&mut self, key: String, point: AxisPoint) -> Result<AxisPoint, Fault> {
        if point.number > 7 {
            return Err(Fault::new(
                format!("{key}.point"),
                point.number,
                "a number from 0 to 7",
            ));
        }
        if !point.x_mm.is_finite() {
            return Err(Fault::new(
                format!("{key}.x_mm"),
                point.x_mm,
                "a finite position",
            ));
        }
        if let Some((_, other)) = self
            .points
            .iter()
            .find(|(taken, _)| taken.number == point.number)
        {
            let fault = Fault::new(format!("{key}.point"), point.number, "a point of its own");
            return Err(fault.against(format!("{other}.point")));
        }
        if let Some((_, other)) = self
            .points
            .iter()
            .find(|(taken, _)| (taken.x_mm - point.x_mm).abs() < 1e-3)
        {
            let fault = Fault::new(format!("{key}.x_mm"), point.x_mm, "a position of its own");
            return Err(fault.against(format!("{other}.x_mm")));
        }
        self.points.push((point, key));
        Ok(point)
    }

    fn beam(
        &mut self,
        key: String,
        name: &str,
        input: Option<DigitalInput>,
    ) -> Result<DigitalInput, Fault> {
        let quoted = format!("\"{name}\"");
        let Some(beam) = input else {
            return Err(Fault::new(key, quoted, "the name of a digital input"));
        };
        if let Some((_, other)) = self.beams.iter().find(|(taken, _)| *taken == beam) {
            return Err(Fault::new(key, quoted, "a beam of its own").against(other.clone()));
        }
        self.beams.push((beam, key));
        Ok(beam)
    }
}
