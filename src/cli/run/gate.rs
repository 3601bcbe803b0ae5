//! Whether a lot may be run at all, looked at before anything is opened or moved.

use super::RunArgs;
use crate::cli::calibrate;
use config::{ConfigError, Plant, load_recipe};
use history::{
    AlarmRecord, Archive, HistoryError, Identity, LOT_NAME, LotRecord, LotStanding, LotState,
    Store, is_lot_name,
};
use machine::dut::Recipe;
use machine::view::OrderRefusal;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Why a lot is not run. The text is that of the command line, where it names the option.
#[derive(Debug, thiserror::Error)]
pub enum NotAdmitted {
    /// A name that no row may have.
    #[error("--lot: found {found:?}, expected {LOT_NAME}")]
    Name {
        /// The name.
        found: String,
    },
    /// A lot without parts.
    #[error("--count: found 0, expected at least 1")]
    NoParts,
    /// There is no such recipe, it is wrong, or this plant cannot measure it.
    #[error(transparent)]
    Recipe(#[from] ConfigError),
    /// Golden checks are asked for and nothing is certified for this coil voltage.
    #[error(
        "{}: [golden_check]: found a check and no golden part of {nominal_v} V, expected one in {golden}",
        file.display()
    )]
    NoGoldenPart {
        /// Where the check is asked for.
        file: PathBuf,
        /// Nominal coil voltage of the recipe.
        nominal_v: f64,
        /// Where golden parts stand.
        golden: String,
    },
    /// A retest of a lot that nobody has run.
    #[error("--retest: found no run of lot \"{lot}\", expected one whose parts are tested again")]
    NothingToRetest {
        /// The lot.
        lot: String,
    },
    /// Somebody has to release it first.
    #[error(
        "--lot: \"{lot}\" is held since {}: {}; expected a lot that may be run (relayrig lot release)",
        standing.since,
        standing.why.as_deref().unwrap_or_default()
    )]
    Held {
        /// The lot.
        lot: String,
        /// Since when, and why.
        standing: Box<LotStanding>,
    },
    /// A lot that is not complete goes on with its own recipe.
    #[error(
        "--recipe: found {found}, expected {} {}, by which lot \"{lot}\" was begun (relayrig lot close ends it)",
        standing.recipe,
        standing.recipe_hash.get(..12).unwrap_or_default()
    )]
    OtherRecipe {
        /// The lot.
        lot: String,
        /// Name and hash of the recipe given.
        found: String,
        /// What it was begun with.
        standing: Box<LotStanding>,
    },
    /// The history cannot be read.
    #[error(transparent)]
    History(#[from] HistoryError),
}

impl NotAdmitted {
    /// The same for a person at a screen.
    pub fn at_the_screen(&self) -> OrderRefusal {
        let (en, zh) = match self {
            Self::Name { .. } => (
                format!("the name of a lot has {LOT_NAME}"),
                "批次名称应为 1 至 200 个字符，不能含控制字符，也不能全是空白".into(),
            ),
            Self::NoParts => (
                "a lot has at least one part".into(),
                "批次至少应有一件".into(),
            ),
            Self::Held { lot, standing } => {
                let why = standing.why.as_deref().unwrap_or_default();
                (
                    format!("lot {lot} is held: {why}; release it first"),
                    format!("批次 {lot} 已被扣留：{why}；请先放行"),
                )
            }
            Self::OtherRecipe { lot, standing, .. } => {
                let begun = &standing.recipe;
                (
                    format!(
                        "lot {lot} was begun with recipe {begun} as it was then, and goes on with nothing else; \
                         close it first"
                    ),
                    format!("批次 {lot} 以当时的配方 {begun} 开始，不能更换配方；请先关闭该批次"),
                )
            }
            Self::NothingToRetest { lot } => (
                format!("lot {lot} has no run whose parts could be tested again"),
                format!("批次 {lot} 没有可复测的记录"),
            ),
            Self::Recipe(_) | Self::NoGoldenPart { .. } | Self::History(_) => {
                (self.to_string(), format!("无法开始批次：{self}"))
            }
        };
        OrderRefusal { en, zh }
    }
}

/// The recipe of a lot that may be run; `calibrates`: of golden parts only.
///
/// # Errors
/// The lot is held, was begun with another recipe and is not complete, there is nothing to test again, a golden
/// check without golden parts, or a recipe that this plant cannot measure.
pub fn admit(
    db: &Path,
    plant: &Plant,
    args: &RunArgs,
    calibrates: bool,
) -> Result<Arc<Recipe>, NotAdmitted> {
    if !is_lot_name(&args.lot) {
        let found = args.lot.clone();
        return Err(NotAdmitted::Name { found });
    }
    if args.count == Some(0) && !calibrates {
        return Err(NotAdmitted::NoParts);
    }
    let recipe = load_recipe(&plant.dir, &args.recipe)?;
    plant.admit(&recipe)?;
    if !calibrates {
        pass_gates(db, plant, &recipe, args)?;
    }
    Ok(Arc::new(recipe))
}

fn pass_gates(
    db: &Path,
    plant: &Plant,
    recipe: &Recipe,
    args: &RunArgs,
) -> Result<(), NotAdmitted> {
    if let Some(nominal_v) = recipe.rated_v()
        && plant.lot.golden_check.any()
        && plant.golden.of_nominal(nominal_v).next().is_none()
    {
        return Err(NotAdmitted::NoGoldenPart {
            file: plant.dir.join("lot.toml"),
            nominal_v,
            golden: plant.calibration.golden.clone(),
        });
    }
    let standing = match db.exists() {
        true => Archive::open(db)?.standing(&args.lot)?,
        false => None,
    };
    let lot = args.lot.clone();
    let Some(standing) = standing.map(Box::new) else {
        return match args.retest {
            Some(_) => Err(NotAdmitted::NothingToRetest { lot }),
            None => Ok(()),
        };
    };
    match standing.state {
        LotState::Held => Err(NotAdmitted::Held { lot, standing }),
        LotState::Open | LotState::Running if standing.recipe_hash != recipe.hash => {
            Err(NotAdmitted::OtherRecipe {
                lot,
                found: format!("{} {}", recipe.name, &recipe.hash[..12]),
                standing,
            })
        }
        LotState::Open | LotState::Running | LotState::Complete => Ok(()),
    }
}

/// Why the rig takes no lot of this recipe before it was calibrated again; nothing to say of the simulated one, which
/// is calibrated before every lot.
pub fn uncalibrated(db: &Path, recipe: &Recipe, args: &RunArgs) -> anyhow::Result<Option<String>> {
    if args.rig.sim {
        return Ok(None);
    }
    match recipe.rated_v() {
        Some(nominal_v) => calibrate::why_not(db, nominal_v),
        None => Ok(None),
    }
}

/// Alarm of a rig that takes no lot before it was calibrated again.
pub const INVALID: &str = "calibration_invalid";

/// The lot gets a run without parts, whose alarm says why.
pub fn refuse(db: &Path, recipe: &Recipe, args: &RunArgs, why: &str) -> anyhow::Result<()> {
    let mut store = Store::open(db, &Identity::of_this_program())?;
    let now_us = jiff::Timestamp::now().as_microsecond();
    store.begin_lot(&LotRecord {
        lot: args.lot.clone(),
        recipe: recipe.name.clone(),
        recipe_snapshot: recipe.source_text.clone(),
        recipe_hash: recipe.hash.clone(),
        opened_at_us: now_us,
        retest: args.retest.clone(),
        ..LotRecord::default()
    })?;
    store.alarm(&AlarmRecord {
        lot: Some(args.lot.clone()),
        code: INVALID.into(),
        text: why.to_owned(),
        raised_at_us: now_us,
        ..AlarmRecord::default()
    })?;
    Ok(store.close_lot(&args.lot, now_us)?)
}
