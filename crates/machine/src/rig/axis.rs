//! The point table of the sort axis: the nest, a parking place, and a bin at every other point.
//!
//! The slide has eight points, selected by three outputs; it travels on a rising edge of `axis_drive`. Positions are
//! relative to the nest, along the line.

use super::bin::Bin;
use super::fault::Fault;
use super::point::DigitalInput;
use super::settings::{BinSettings, StationSettings};
use std::collections::BTreeMap;

/// A place of the sort axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum AxisStation {
    /// Over the nest.
    Nest,
    /// Clear of the nest.
    Park,
    /// Over the chute of a bin.
    Bin(Bin),
}

impl AxisStation {
    /// Returns the key in `config/rig.toml`, for example `axis.park` or `bin.pass`.
    pub fn key(self) -> String {
        match self {
            Self::Nest => "axis.nest".to_owned(),
            Self::Park => "axis.park".to_owned(),
            Self::Bin(bin) => format!("bin.{}", bin.name()),
        }
    }
}

/// A point of the slide's point table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisPoint {
    /// Number on the point bits, 0 to 7.
    pub number: u8,
    /// Position relative to the nest, mm.
    pub x_mm: f64,
}

/// A bin of this rig, with its point of the axis and its beam.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Chute {
    bin: Bin,
    point: AxisPoint,
    beam: DigitalInput,
}

/// The points of the sort axis and the beams in the chutes.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisTable {
    nest: AxisPoint,
    park: AxisPoint,
    /// Chutes in the order of the line.
    chutes: Vec<Chute>,
}

impl AxisTable {
    /// Returns the point of a station.
    ///
    /// # Panics
    /// Panics for a bin that the rig lacks.
    pub fn point(&self, station: AxisStation) -> AxisPoint {
        match station {
            AxisStation::Nest => self.nest,
            AxisStation::Park => self.park,
            AxisStation::Bin(bin) => self.chute(bin).point,
        }
    }

    /// Returns the beam in the chute of a bin.
    ///
    /// # Panics
    /// Panics for a bin that the rig lacks.
    pub fn beam(&self, bin: Bin) -> DigitalInput {
        self.chute(bin).beam
    }

    /// Yields the bins of this rig, in the order of the line.
    pub fn bins(&self) -> impl Iterator<Item = Bin> + '_ {
        self.chutes.iter().map(|chute| chute.bin)
    }

    /// Returns true when the rig has this bin.
    pub fn has(&self, bin: Bin) -> bool {
        self.bins().any(|known| known == bin)
    }

    /// Returns the station at a position, within a micrometre; `None` between stations.
    pub fn station_at(&self, x_mm: f64) -> Option<AxisStation> {
        self.stations()
            .find(|station| (self.point(*station).x_mm - x_mm).abs() < 1e-3)
    }

    /// Yields every station.
    pub fn stations(&self) -> impl Iterator<Item = AxisStation> + '_ {
        [AxisStation::Nest, AxisStation::Park]
            .into_iter()
            .chain(self.bins().map(AxisStation::Bin))
    }

    /// Returns the chute of a bin; panics for an unknown bin, which a recipe can never name because loading it checks
    /// its bins.
    fn chute(&self, bin: Bin) -> &Chute {
        let found = self.chutes.iter().find(|chute| chute.bin == bin);
        match found {
            Some(chute) => chute,
            None => panic!("the rig has no bin {bin}"),
        }
    }

    pub(super) fn resolve(
        axis: &BTreeMap<String, StationSettings>,
        bins: &BTreeMap<String, BinSettings>,
        input: impl Fn(&str) -> Option<DigitalInput>,
    ) -> Result<Self, Fault> {
        let mut taken = PointsInUse::default();
        let nest = taken.station("nest", axis)?;
        let park = taken.station("park", axis)?;
        for needed in [Bin::PASS, Bin::RETEST] {
            if !bins.contains_key(needed.name()) {
                return Err(Fault::new(format!("bin.{needed}"), "nothing", "a bin"));
            }
        }
        let mut in_order: Vec<_> = bins.iter().collect();
        in_order.sort_by(|(_, one), (_, other)| one.x_mm.total_cmp(&other.x_mm));
        let chutes = in_order
            .into_iter()
            .map(|(name, settings)| taken.chute(name, settings, &input))
            .collect::<Result<_, _>>()?;
        Ok(Self { nest, park, chutes })
    }
}

/// Numbers, positions and beams in use, each with its key.
#[derive(Default)]
struct PointsInUse {
    points: Vec<(AxisPoint, String)>,
    beams: Vec<(DigitalInput, String)>,
}

impl PointsInUse {
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

    fn chute(
        &mut self,
        name: &str,
        settings: &BinSettings,
        input: impl Fn(&str) -> Option<DigitalInput>,
    ) -> Result<Chute, Fault> {
        let key = format!("bin.{name}");
        let Some(bin) = Bin::from_name(name) else {
            let expected = format!(
                "a name of at most {} characters: a to z, 0 to 9 and _",
                Bin::LONGEST
            );
            return Err(Fault::new(key, format!("the name \"{name}\""), expected));
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
        Ok(Chute { bin, point, beam })
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
