//! Instruments of a rig: in the clock and behind the lock of its modules, reached by links of their own.

use std::sync::Arc;

use crate::scpi::bench::{Desk, Instruments};
use crate::scpi::serve::{self, Plug, Served};
use crate::{SharedRig, SimError};

impl Desk for SharedRig {
    fn at(&self, now_us: u64, work: &mut dyn FnMut(&mut Instruments)) {
        let rig = &mut *self.rig();
        rig.advance(now_us);
        if let Some(instruments) = rig.instruments_mut() {
            work(instruments);
        }
    }

    fn look(&self, work: &mut dyn FnMut(&Instruments)) {
        if let Some(instruments) = self.rig().instruments_mut() {
            work(instruments);
        }
    }
}

impl SharedRig {
    /// Returns a connector for the link of each instrument, or of an adapter, in virtual time, on the current
    /// runtime. Rig time continues from its present value. Empty for a rig without instruments.
    pub fn instrument_plugs(&self) -> Vec<(String, Plug)> {
        serve::plugs(Arc::new(self.clone()), self.now_us())
    }

    /// Opens the links of the instruments in real time and serves them until the result is dropped. Where
    /// [`crate::pty::serve`] has begun before, the instruments share its rig time.
    ///
    /// # Errors
    /// Fails when the system refuses a socket or a pseudo-terminal.
    pub async fn serve_instruments(&self) -> Result<Served, SimError> {
        let origin = self.real_origin();
        serve::in_real_time(Arc::new(self.clone()), origin.into()).await
    }
}
