//! What a stage has read, with the points of the rig.

use crate::dut::ssr::points::{Device, Points};
use crate::instrument::query::Waveform;
use crate::instrument::readings::Readings;
use std::sync::Arc;

/// An instrument has delivered other values than its programs return.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NotDelivered(pub Device);

/// Readings of a stage with the points of the rig.
#[derive(Clone, Copy)]
pub struct Given<'a> {
    /// Points and instruments.
    pub points: &'a Points,
    /// Readings.
    pub readings: &'a Readings,
}

impl<'a> Given<'a> {
    /// Returns the numbers of each program of an instrument that has delivered numbers, in order.
    ///
    /// # Errors
    /// Fails unless there are as many programs as `COUNT`, and every number is finite.
    pub fn numbers<const COUNT: usize>(
        &self,
        device: Device,
    ) -> Result<[&'a [f64]; COUNT], NotDelivered> {
        let all = self.readings.delivered(self.points.instrument(device));
        let all = all.map(|it| it.numbers.as_slice());
        let all: Vec<&[f64]> = all.filter(|it| !it.is_empty()).collect();
        let finite = all
            .iter()
            .all(|it| it.iter().all(|number| number.is_finite()));
        match <[&[f64]; COUNT]>::try_from(all) {
            Ok(numbers) if finite => Ok(numbers),
            Ok(_) | Err(_) => Err(NotDelivered(device)),
        }
    }

    /// Returns the last of two readings one after the other, and how far it is from the first.
    ///
    /// # Errors
    /// Fails unless the program has delivered two numbers.
    pub fn settled(device: Device, numbers: &[f64]) -> Result<(f64, f64), NotDelivered> {
        let [first, last] = numbers else {
            return Err(NotDelivered(device));
        };
        Ok((*last, last - first))
    }

    /// Returns the only number of each program of an instrument, in order.
    ///
    /// # Errors
    /// As [`Self::numbers`], and when a program has delivered more than one number.
    pub fn singles<const COUNT: usize>(
        &self,
        device: Device,
    ) -> Result<[f64; COUNT], NotDelivered> {
        let numbers = self.numbers::<COUNT>(device)?;
        match numbers.iter().all(|it| it.len() == 1) {
            true => Ok(numbers.map(|it| it[0])),
            false => Err(NotDelivered(device)),
        }
    }

    /// Returns the waveforms of the digitizer, in order.
    ///
    /// # Errors
    /// Fails unless there are two.
    pub fn waveforms(&self) -> Result<[Arc<Waveform>; 2], NotDelivered> {
        let device = Device::Digitizer;
        let all = self.readings.delivered(self.points.instrument(device));
        let all: Vec<Arc<Waveform>> = all.filter_map(|it| it.waveform.clone()).collect();
        all.try_into().map_err(|_| NotDelivered(device))
    }
}
