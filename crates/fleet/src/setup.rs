//! Makes the schema of this program in a database, or brings an older one up to date.

use crate::error::{FleetError, Result};
use crate::link::Link;
use config::FleetTarget;

/// Steps from one schema to the next: the first one makes schema 1. Existing steps never change, and a step only adds,
/// so that older rigs keep working.
const STEPS: [&str; 2] = [include_str!("schema/v1.sql"), include_str!("schema/v2.sql")];

/// Views and rights, which every set-up makes anew.
const VIEWS: &str = include_str!("schema/views.sql");

/// Schema that this program writes.
pub const SCHEMA: i32 = STEPS.len() as i32;

/// Months for which a set-up makes partitions ahead; rigs make a missing one themselves.
pub const MONTHS_AHEAD: i64 = 24;

/// Result of a set-up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Setup {
    /// Number of the schema before; 0 for none.
    pub from: i32,
    /// Number of the schema now.
    pub to: i32,
    /// Number of partitions made.
    pub partitions: i32,
}

/// Makes the schema `relayrig` with its roles and partitions, in one transaction. In an existing schema, adds only
/// missing steps and partitions; leaves the views of a newer schema alone.
///
/// # Errors
/// Fails when the schema belongs to another program, and when the user may not make schemas or roles; then nothing has
/// changed.
pub async fn set_up(target: &FleetTarget) -> Result<Setup> {
    const DOING: &str = "making the schema";
    let mut link = Link::connect(target).await?;
    let found = link.schema().await?;
    let name = link.target.clone();
    let from = found.unwrap_or(0);
    let mut script = String::new();
    if found.is_none() {
        script.push_str("CREATE SCHEMA relayrig;\nCOMMENT ON SCHEMA relayrig IS 'Histories of relay test rigs';\n");
    }
    let program = env!("CARGO_PKG_VERSION");
    for (step, sql) in (1_i32..)
        .zip(STEPS)
        .skip(usize::try_from(from).unwrap_or(0))
    {
        script.push_str(sql);
        script.push_str(&format!(
            "INSERT INTO relayrig.schema_step (step, program) VALUES ({step}, 'relayrig {program}');\n"
        ));
    }
    if from <= SCHEMA {
        script.push_str(VIEWS);
    }
    let doing = |error| FleetError::of(&name, DOING, error);
    let tx = link.client.transaction().await.map_err(doing)?;
    tx.batch_execute(&script).await.map_err(doing)?;
    let months = format!(
        "SELECT relayrig.ensure_months((extract(epoch FROM now()) * 1000000)::bigint,
           (extract(epoch FROM now() + interval '{MONTHS_AHEAD} months') * 1000000)::bigint)"
    );
    let partitions = tx.query_one(&months, &[]).await.map_err(doing)?.get(0);
    tx.commit().await.map_err(doing)?;
    Ok(Setup {
        from,
        to: from.max(SCHEMA),
        partitions,
    })
}
