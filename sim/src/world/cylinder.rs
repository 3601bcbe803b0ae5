//! One pneumatic stroke after another: position 0 at rest, 1 at the far end.

/// A cylinder and the stroke it is on.
#[derive(Debug, Clone)]
pub struct Cylinder {
    mean_us: f64,
    from: f64,
    to: f64,
    start_us: u64,
    end_us: u64,
    far: bool,
    arrived: bool,
}

impl Cylinder {
    /// At rest, with a mean stroke time.
    pub fn new(mean_ms: f64) -> Self {
        Self {
            mean_us: mean_ms * 1000.0,
            from: 0.0,
            to: 0.0,
            start_us: 0,
            end_us: 0,
            far: false,
            arrived: true,
        }
    }

    /// Where it is, 0 to 1.
    pub fn position(&self, now_us: u64) -> f64 {
        if now_us >= self.end_us {
            return self.to;
        }
        let share = (now_us - self.start_us) as f64 / (self.end_us - self.start_us) as f64;
        self.from + (self.to - self.from) * share
    }

    /// Stands at the end it starts from.
    pub fn at_rest(&self, now_us: u64) -> bool {
        self.position(now_us) <= 0.0
    }

    /// Stands at the far end.
    pub fn at_far(&self, now_us: u64) -> bool {
        self.position(now_us) >= 1.0
    }

    /// Which end it was last sent to.
    pub fn is_sent_far(&self) -> bool {
        self.far
    }

    /// Sends it to an end; a full stroke takes the mean time `scatter`, and it `stalls` short of
    /// the far end if asked to. Returns false if it was already sent there.
    pub fn send(&mut self, far: bool, now_us: u64, scatter: f64, stalls: bool) -> bool {
        if far == self.far {
            return false;
        }
        self.from = self.position(now_us);
        self.far = far;
        self.to = match (far, stalls) {
            (true, false) => 1.0,
            (true, true) => 0.55_f64.max(self.from),
            (false, _) => 0.0,
        };
        self.start_us = now_us;
        let travel = self.mean_us * scatter.max(0.4) * (self.to - self.from).abs();
        self.end_us = now_us + (travel as u64).max(1);
        self.arrived = false;
        true
    }

    /// Instant at which the stroke ends, until [`Cylinder::arrive`] has seen it.
    pub fn due_us(&self) -> Option<u64> {
        (!self.arrived).then_some(self.end_us)
    }

    /// Takes note of the end of a stroke that is due.
    pub fn arrive(&mut self) {
        self.arrived = true;
    }

    /// Duration of the present stroke, microseconds.
    pub fn stroke_us(&self) -> u64 {
        self.end_us - self.start_us
    }
}
