//! One pneumatic cylinder: position 0 at rest, 1 at the far end.

/// A cylinder and its current stroke.
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
    /// Creates a cylinder at rest; a full stroke takes `mean_ms` on average.
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

    /// Returns the position, 0 to 1.
    pub fn position(&self, now_us: u64) -> f64 {
        if now_us >= self.end_us {
            return self.to;
        }
        let share = (now_us - self.start_us) as f64 / (self.end_us - self.start_us) as f64;
        self.from + (self.to - self.from) * share
    }

    /// Checks whether the cylinder is at its rest end.
    pub fn at_rest(&self, now_us: u64) -> bool {
        self.position(now_us) <= 0.0
    }

    /// Checks whether the cylinder is at its far end.
    pub fn at_far(&self, now_us: u64) -> bool {
        self.position(now_us) >= 1.0
    }

    /// Checks whether the last command was the far end.
    pub fn is_commanded_far(&self) -> bool {
        self.far
    }

    /// Starts a stroke to an end. A full stroke takes the mean time multiplied by `scatter`; with `stalls` the cylinder
    /// stops short of the far end. Returns false when that end was already commanded.
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

    /// Returns the instant at which the stroke ends; `None` after [`Cylinder::arrive`].
    pub fn due_us(&self) -> Option<u64> {
        (!self.arrived).then_some(self.end_us)
    }

    /// Ends the stroke that is due.
    pub fn arrive(&mut self) {
        self.arrived = true;
    }

    /// Returns the duration of the present stroke, microseconds.
    pub fn stroke_us(&self) -> u64 {
        self.end_us - self.start_us
    }
}
