//! Parameters of one relay, in SI units.

use crate::config::ConfigError;
use crate::table::{Entry, Read};

macro_rules! parameters {
    ($($(#[$doc:meta])* $name:ident = $value:expr, $rule:ident;)*) => {
        /// Parameters of a relay, named as in the equations in [`super`]; all coordinates refer to the pole face. The
        /// default is the reference relay of this project: 12 V, 400 ohm, one changeover contact.
        #[allow(non_snake_case)] // the names of the equations and of the files that carry them
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct Parameters { $($(#[$doc])* pub $name: f64),* }

        impl Parameters {
            /// Names of all parameters, in order.
            pub const NAMES: &'static [&'static str] = &[$(stringify!($name)),*];

            /// Returns a parameter by its name.
            pub fn get(&self, name: &str) -> Option<f64> {
                match name { $(stringify!($name) => Some(self.$name),)* _ => None }
            }

            /// Sets a parameter by its name; returns false for an unknown name.
            pub fn set(&mut self, name: &str, value: f64) -> bool {
                match name { $(stringify!($name) => self.$name = value,)* _ => return false }
                true
            }

            /// Returns name and permitted range of the first parameter that lies outside its range; `None` when all are
            /// valid.
            pub fn fault(&self) -> Option<(&'static str, &'static str)> {
                let found = [$((stringify!($name), self.$name, Rule::$rule)),*];
                found.into_iter().find(|(_, value, rule)| !rule.admits(*value)).map(|(name, _, rule)| (name, rule.text()))
            }
        }

        impl Default for Parameters {
            fn default() -> Self { Self { $($name: $value),* } }
        }
    };
}

parameters! {
    /// Permeability of vacuum, henry per metre.
    mu0 = 1.256_637_061_435_917_3e-6, Positive;
    /// Turns of the coil.
    N = 3300.0, Positive;
    /// Coil resistance at 23 C, ohm.
    R23 = 400.0, Positive;
    /// Temperature of the copper, degrees Celsius.
    T = 23.0, Finite;
    /// Temperature coefficient of the resistance relative to 23 C, 1/K (copper: 1 / 257.5).
    alpha23 = 1.0 / 257.5, NotNegative;
    /// Conductance of the eddy currents as one shorted turn, siemens.
    k_ec = 2500.0, Positive;
    /// Area of the pole face, m2.
    A = 25e-6, Positive;
    /// Fringing permeance per metre of gap, H/m.
    Pf = 2e-8, NotNegative;
    /// Residual reluctance of joints and plating, 1/H.
    Rr = 2.2e6, NotNegative;
    /// Reluctance of the core without saturation, 1/H.
    Rc0 = 1e6, NotNegative;
    /// Saturation flux, Wb.
    phis = 3e-5, Positive;
    /// Mass of the armature, kg.
    m_a = 0.9e-3, Positive;
    /// Travel of the armature from backstop to seat, m.
    X = 0.55e-3, Positive;
    /// Force of the return spring at the backstop, N.
    F_r0 = 0.16, Finite;
    /// Stiffness of the return spring, N/m.
    k_r = 250.0, NotNegative;
    /// Viscous drag of the armature, N s/m.
    c_a = 0.03, NotNegative;
    /// Stiffness of backstop and seat, N/m^1.5.
    k_s = 1e10, Positive;
    /// Loss coefficient of backstop and seat, s/m.
    chi_s = 6.0, NotNegative;
    /// Mass of the moving contact, kg.
    m_c = 0.12e-3, Positive;
    /// Stiffness of the leaf, N/m.
    k_l = 1500.0, Positive;
    /// Damping of the leaf, N s/m.
    c_l = 0.025, NotNegative;
    /// Offset of the leaf from the armature at the backstop, m; below zero it presses on NC.
    d0 = -0.08e-3, Finite;
    /// Distance between the two fixed contacts, m.
    G = 0.33e-3, Positive;
    /// Stiffness of both fixed contacts, N/m^1.5.
    k_c = 1e8, Positive;
    /// Loss coefficient of both contacts, s/m.
    chi_c = 4.0, NotNegative;
}

impl Parameters {
    /// Returns the coil resistance at the temperature of the copper, ohm.
    pub fn coil_ohm(&self) -> f64 {
        self.R23 * (1.0 + self.alpha23 * (self.T - 23.0))
    }
}

impl Read for Parameters {
    const FORM: &'static str = "a table";

    fn read(entry: &Entry) -> Result<Self, ConfigError> {
        let keys = entry.table()?;
        let mut own = Self::default();
        for name in Self::NAMES {
            own.set(name, keys.get(name)?);
        }
        keys.finish()?;
        match own.fault() {
            None => Ok(own),
            Some((name, expected)) => Err(keys.wrong(name, expected)),
        }
    }
}

/// Permitted range of a parameter.
#[derive(Clone, Copy)]
enum Rule {
    Positive,
    NotNegative,
    Finite,
}

impl Rule {
    fn admits(self, value: f64) -> bool {
        match self {
            Self::Positive => value.is_finite() && value > 0.0,
            Self::NotNegative => value.is_finite() && value >= 0.0,
            Self::Finite => value.is_finite(),
        }
    }

    fn text(self) -> &'static str {
        match self {
            Self::Positive => "a finite number above 0",
            Self::NotNegative => "a finite number, 0 or more",
            Self::Finite => "a finite number",
        }
    }
}
