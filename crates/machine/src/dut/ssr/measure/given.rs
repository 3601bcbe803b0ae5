//! Readings of a stage, by instrument and point, for its conclusion.

use crate::dut::Reason;
use crate::dut::ssr::Finding;
use crate::dut::ssr::points::{Device, DigitalIn, Points};
use crate::instrument::query::Waveform;
use crate::instrument::readings::Readings;
use std::any::Any;
use std::sync::Arc;

/// An instrument has delivered other values than its programs return.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NotDelivered(pub Device);

impl From<NotDelivered> for Reason {
    fn from(NotDelivered(device): NotDelivered) -> Self {
        Finding::NotDelivered.with(device.name())
    }
}

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
        let all = self.lists(device, COUNT)?;
        all.try_into().map_err(|_| NotDelivered(device))
    }

    /// Returns, for each program of an instrument that has delivered numbers, those numbers, in order.
    ///
    /// # Errors
    /// Fails unless there are `count` programs, and every number is finite.
    pub fn lists(&self, device: Device, count: usize) -> Result<Vec<&'a [f64]>, NotDelivered> {
        let all = self.readings.delivered(self.points.instrument(device));
        let all = all.map(|it| it.numbers.as_slice());
        let all: Vec<&[f64]> = all.filter(|it| !it.is_empty()).collect();
        let mut numbers = all.iter().flat_map(|it| it.iter());
        match all.len() == count && numbers.all(|it| it.is_finite()) {
            true => Ok(all),
            false => Err(NotDelivered(device)),
        }
    }

    /// Returns the second of two readings, and its difference from the first.
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
    /// Fails unless there are `COUNT`.
    pub fn waveforms<const COUNT: usize>(&self) -> Result<[Arc<Waveform>; COUNT], NotDelivered> {
        let device = Device::Digitizer;
        let all = self.readings.delivered(self.points.instrument(device));
        let all: Vec<Arc<Waveform>> = all.filter_map(|it| it.waveform.clone()).collect();
        all.try_into().map_err(|_| NotDelivered(device))
    }

    /// Returns the last state of an input of the fixture.
    pub fn is_on(&self, point: DigitalIn) -> bool {
        self.readings.states(self.points.input(point)).last() == Some(true)
    }

    /// Returns the result of the last conversion, of two waveforms.
    ///
    /// # Errors
    /// Fails when the digitizer has delivered another number of waveforms, or when the conversion has another type.
    pub fn converted<T: Any + Copy>(&self) -> Result<T, NotDelivered> {
        let [_control, _output] = self.waveforms()?;
        let last = self.readings.converted.last();
        let value = last.and_then(|it| it.get().copied());
        value.ok_or(NotDelivered(Device::Digitizer))
    }
}
