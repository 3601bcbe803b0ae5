//! Whether a lot may be run at all, looked at before anything is opened or moved.

use super::calibration;
use super::exit::Cause;
use super::lot::Purpose;
use super::order::LotOrder;
use super::source::RigSource;
use config::{ConfigError, Plant, load_recipe};
use history::{
    AlarmRecord, Archive, HistoryError, Identity, LOT_NAME, LotRecord, LotState, LotStatus, Row,
    RunEndRecord, Store, is_lot_name,
};
use machine::dut::Recipe;
use machine::station::trouble::Alarm;
use machine::station::turn::Ending;
use std::path::Path;
use std::sync::Arc;
use texts::{Lang, Message};

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
        standing: Box<LotStatus>,
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
        standing: Box<LotStatus>,
    },
    /// The history cannot be read.
    #[error(transparent)]
    History(#[from] HistoryError),
}

impl NotAdmitted {
    /// The same for a person at a screen.
    pub fn at_the_screen(&self) -> Message {
        let of = |code| Message::new("refusal", code);
        match self {
            Self::Name { .. } => of("lot_name"),
            Self::NoParts => of("lot_without_parts"),
            Self::Held { lot, standing } => of("lot_held")
                .with("lot", lot)
                .with("why", standing.why.as_deref().unwrap_or_default()),
            Self::OtherRecipe { lot, standing, .. } => of("other_recipe")
                .with("lot", lot)
                .with("recipe", &standing.recipe),
            Self::NothingToRetest { lot } => of("nothing_to_retest").with("lot", lot),
            Self::Recipe(_) | Self::History(_) => of("lot_not_begun").with("detail", self),
        }
    }
}

/// The recipe of a lot that may be run.
///
/// # Errors
/// The lot is held, was begun with another recipe and is not complete, there is nothing to test again, or a
/// recipe that this plant cannot measure.
pub fn admit(
    db: &Path,
    plant: &Plant,
    order: &LotOrder,
    purpose: Purpose,
) -> Result<Arc<Recipe>, NotAdmitted> {
    if !is_lot_name(&order.lot) {
        let found = order.lot.clone();
        return Err(NotAdmitted::Name { found });
    }
    if order.count == Some(0) && purpose == Purpose::Lot {
        return Err(NotAdmitted::NoParts);
    }
    let recipe = load_recipe(&plant.dir, &order.recipe)?;
    plant.admit(&recipe)?;
    if purpose == Purpose::Lot {
        pass_gates(db, &recipe, order)?;
    }
    Ok(Arc::new(recipe))
}

fn pass_gates(
    db: &Path,
    recipe: &Recipe,
    order: &LotOrder,
) -> Result<(), NotAdmitted> {
    let standing = match db.exists() {
        true => Archive::open(db)?.standing(&order.lot)?,
        false => None,
    };
    let lot = order.lot.clone();
    let Some(standing) = standing.map(Box::new) else {
        return match order.retest {
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
///
/// # Errors
/// The history cannot be read.
pub fn uncalibrated(
    db: &Path,
    recipe: &Recipe,
    source: &RigSource,
) -> anyhow::Result<Option<String>> {
    if source.is_simulated() {
        return Ok(None);
    }
    match recipe.device.part().nominal_v {
        Some(nominal_v) => calibration::why_not(db, nominal_v),
        None => Ok(None),
    }
}

/// The lot gets a run without parts, whose alarm says why.
///
/// # Errors
/// The history cannot be written.
pub fn refuse(db: &Path, recipe: &Recipe, order: &LotOrder, cause: &Cause) -> anyhow::Result<()> {
    let mut store = Store::open(db, &Identity::of_this_program())?;
    let now_us = jiff::Timestamp::now().as_microsecond();
    store.begin_lot(&LotRecord {
        lot: order.lot.clone(),
        recipe: recipe.name.clone(),
        recipe_snapshot: recipe.source_text.clone(),
        recipe_hash: recipe.hash.clone(),
        opened_at_us: now_us,
        retest: order.retest.clone(),
        ..LotRecord::default()
    })?;
    let alarm = Alarm::calibration_invalid(&cause.text);
    let alarm = Row::Alarm(AlarmRecord {
        lot: Some(order.lot.clone()),
        code: alarm.code.name(),
        text: alarm.text(Lang::En),
        args: alarm.args,
        raised_at_us: now_us,
        ..AlarmRecord::default()
    });
    let ended = Row::RunEnded(RunEndRecord {
        lot: order.lot.clone(),
        ended: Ending::Alarm,
        cause: Some((cause.code.clone(), cause.text.clone())),
    });
    store.record(&[alarm, ended])?;
    Ok(store.close_lot(&order.lot, now_us)?)
}
