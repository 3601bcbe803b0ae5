//! The sort axis: an electric slide with a point table, trapezoidal moves, and brakes that hold without servo.

/// The slide; all positions in mm from the nest.
#[derive(Debug, Clone)]
pub struct Axis {
    speed: f64,
    acceleration: f64,
    points: [Option<f64>; 8],
    from: f64,
    to: f64,
    start_us: u64,
    end_us: u64,
    servo: bool,
    alarm: bool,
    in_position: bool,
    moving: bool,
}

/// Shortest time from a start command to the drive's response, microseconds.
const ANSWER_US: u64 = 5_000;

impl Axis {
    /// Creates a braked slide at `x_mm`; speed in mm/s, acceleration in mm/s2.
    pub fn new(speed: f64, acceleration: f64, points: [Option<f64>; 8], x_mm: f64) -> Self {
        Self {
            speed,
            acceleration,
            points,
            from: x_mm,
            to: x_mm,
            start_us: 0,
            end_us: 0,
            servo: false,
            alarm: false,
            in_position: false,
            moving: false,
        }
    }

    /// Returns the position, mm.
    pub fn x_mm(&self, now_us: u64) -> f64 {
        if now_us >= self.end_us {
            return self.to;
        }
        let run = now_us.saturating_sub(self.start_us) as f64 * 1e-6;
        let left = (self.end_us - now_us) as f64 * 1e-6;
        let whole = (self.to - self.from).abs();
        let ramp = (self.speed / self.acceleration).min((whole / self.acceleration).sqrt());
        let risen = |t: f64| match t <= ramp {
            true => 0.5 * self.acceleration * t * t,
            false => self.acceleration * ramp * (t - 0.5 * ramp),
        };
        let way = if run < left {
            risen(run)
        } else {
            whole - risen(left)
        };
        self.from + way.clamp(0.0, whole).copysign(self.to - self.from)
    }

    /// Checks whether a move is running.
    pub fn is_moving(&self) -> bool {
        self.moving
    }

    /// Checks whether the drive has tripped.
    pub fn is_alarmed(&self) -> bool {
        self.alarm
    }

    /// Checks whether the slide has reached its last target point.
    pub fn is_in_position(&self) -> bool {
        self.in_position
    }

    /// Switches the servo; without servo the brakes stop and hold the slide.
    pub fn servo(&mut self, on: bool, now_us: u64) {
        if self.servo && !on {
            self.brake(now_us);
        }
        self.servo = on;
    }

    /// Starts a move to a point of the table; returns false if the drive does not start.
    pub fn go(&mut self, point: usize, now_us: u64) -> bool {
        let Some(target) = self.points.get(point).copied().flatten() else {
            return false;
        };
        if !self.servo || self.alarm {
            return false;
        }
        self.from = self.x_mm(now_us);
        self.to = target;
        let way = (self.to - self.from).abs();
        let ramp_way = self.speed * self.speed / self.acceleration;
        let time_s = match way >= ramp_way {
            true => way / self.speed + self.speed / self.acceleration,
            false => 2.0 * (way / self.acceleration).sqrt(),
        };
        self.start_us = now_us;
        self.end_us = now_us + ((time_s * 1e6) as u64).max(ANSWER_US);
        self.in_position = false;
        self.moving = true;
        true
    }

    /// Trips the drive at its present position.
    pub fn trip(&mut self, now_us: u64) {
        self.brake(now_us);
        self.alarm = true;
    }

    /// Clears the alarm.
    pub fn reset(&mut self) {
        self.alarm = false;
    }

    /// Returns the instant at which the move ends.
    pub fn due_us(&self) -> Option<u64> {
        self.moving.then_some(self.end_us)
    }

    /// Ends the move that is due.
    pub fn arrive(&mut self) {
        self.moving = false;
        self.in_position = true;
    }

    fn brake(&mut self, now_us: u64) {
        let here = self.x_mm(now_us);
        self.from = here;
        self.to = here;
        self.end_us = now_us;
        self.moving = false;
        self.in_position = false;
    }
}
