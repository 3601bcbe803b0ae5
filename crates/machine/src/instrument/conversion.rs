//! Conversions: long calculations over waveforms, which delay no line because they run beside the cycle.

use super::query::Waveform;
use std::any::Any;
use std::fmt;
use std::sync::Arc;

/// Result of a conversion; only the kind of device knows its type.
#[derive(Clone)]
pub struct Converted(Arc<dyn Any + Send + Sync>);

impl Converted {
    /// Returns the result as the type that the conversion gave it; `None` for another type.
    pub fn get<T: Any>(&self) -> Option<&T> {
        self.0.downcast_ref()
    }
}

impl fmt::Debug for Converted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Converted")
    }
}

impl PartialEq for Converted {
    /// Returns true when both are clones of one result.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

type Calculation = Arc<dyn Fn(&[Arc<Waveform>]) -> Converted + Send + Sync>;

/// A function of the waveforms that a stage has read. Equal waveforms give equal results.
#[derive(Clone)]
pub struct Conversion(Calculation);

impl Conversion {
    /// Makes a conversion from a function.
    pub fn new<T: Any + Send + Sync>(
        calculation: impl Fn(&[Arc<Waveform>]) -> T + Send + Sync + 'static,
    ) -> Self {
        Self(Arc::new(move |waveforms| {
            Converted(Arc::new(calculation(waveforms)))
        }))
    }

    /// Runs the function; takes milliseconds for records of 100,000 samples.
    pub fn run(&self, waveforms: &[Arc<Waveform>]) -> Converted {
        (self.0)(waveforms)
    }
}

impl fmt::Debug for Conversion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Conversion")
    }
}

impl PartialEq for Conversion {
    /// Returns true when both are clones of one conversion.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}
