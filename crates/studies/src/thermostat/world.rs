//! Conditions of a batch in the study: kind of part, and deviations from the default world.

/// Kind of part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kind {
    /// Name in reports.
    pub name: &'static str,
    /// Name of the recipe.
    pub recipe: &'static str,
    /// Lags of body and disc in air, s.
    pub lags_s: [f64; 2],
}

impl Kind {
    /// A small snap-disc thermostat.
    pub const KSD9700: Self = Self {
        name: "KSD9700",
        recipe: "thermostat-ksd9700",
        lags_s: [35.0, 4.0],
    };
    /// A snap-disc thermostat with a heavy cap.
    pub const KSD301: Self = Self {
        name: "KSD301",
        recipe: "thermostat-ksd301",
        lags_s: [90.0, 8.0],
    };
}

/// Deviations from the default world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct World {
    /// Name in reports.
    pub name: &'static str,
    /// Ratio of the lag of the parts to that in the default world: one value for the even sockets, one for the odd
    /// ones.
    pub lag: [f64; 2],
    /// Scatter of a switching from cycle to cycle, one standard deviation, K.
    pub scatter_k: f64,
    /// Ratio of the power of the heater to the nominal one.
    pub mains: f64,
    /// The same ratio after the mains voltage has stepped in the middle of a batch.
    pub mains_later: f64,
    /// Temperature of the room, C; `None` draws it from 18 to 28 C.
    pub ambient_c: Option<f64>,
    /// True when the parts enter with the temperature of the chamber instead of that of the room.
    pub warm_parts: bool,
}

/// Scatter of a switching in the default world, K.
const SCATTER_K: f64 = 0.15;

/// Nominal lag and mains, cold parts, a room of 18 to 28 C.
pub const DEFAULT: World = World {
    name: "default world",
    lag: [1.0; 2],
    scatter_k: SCATTER_K,
    mains: 1.0,
    mains_later: 1.0,
    ambient_c: None,
    warm_parts: false,
};

/// Other worlds in which results must stay within their uncertainty.
pub const OTHERS: [World; 10] = [
    World {
        name: "lag x0.5",
        lag: [0.5; 2],
        ..DEFAULT
    },
    World {
        name: "lag x2",
        lag: [2.0; 2],
        ..DEFAULT
    },
    World {
        name: "lag x0.5 and x2 mixed",
        lag: [0.5, 2.0],
        ..DEFAULT
    },
    World {
        name: "scatter x2",
        scatter_k: 2.0 * SCATTER_K,
        ..DEFAULT
    },
    World {
        name: "gain x0.5",
        mains: 0.5,
        mains_later: 0.5,
        ..DEFAULT
    },
    World {
        name: "gain x1.5",
        mains: 1.5,
        mains_later: 1.5,
        ..DEFAULT
    },
    World {
        name: "mains step -15 %",
        mains_later: 0.85,
        ..DEFAULT
    },
    World {
        name: "ambient 10 C",
        ambient_c: Some(10.0),
        ..DEFAULT
    },
    World {
        name: "ambient 35 C",
        ambient_c: Some(35.0),
        ..DEFAULT
    },
    World {
        name: "parts enter warm",
        warm_parts: true,
        ..DEFAULT
    },
];
