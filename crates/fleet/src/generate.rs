//! Fills a database with made-up histories of many rigs, to try questions at size. Each rig is one transaction; the
//! server draws the values, so that only a few numbers go over the network.

use crate::error::{FleetError, Result};
use crate::link::Link;
use config::FleetTarget;

/// Plant of the made-up rigs.
pub const SITE: &str = "made-up";
/// Number of measurements of a part.
pub const VALUES: i64 = 25;
const DOING: &str = "making up histories";

/// Size of the made-up histories.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Wanted {
    /// Number of parts of all rigs together.
    pub parts: i64,
    /// Number of rigs.
    pub rigs: i64,
    /// Time over which the parts of each rig are spread, up to now, days.
    pub days: i64,
}

const PARAMETERS: &str = "
INSERT INTO relayrig.recipe VALUES ('made-up', 'made-up', '', 0) ON CONFLICT DO NOTHING;
INSERT INTO relayrig.parameter (key, meaning) SELECT 'made_up_' || n || '_v', 'made up' FROM generate_series(1, 25) AS n
  ON CONFLICT DO NOTHING";

/// Makes the rig `$2` with its history; `$1` is the plant.
const RIG: &str = "
WITH made AS (INSERT INTO relayrig.rig (site, rig) VALUES ($1, $2) RETURNING id)
INSERT INTO relayrig.history (rig_id, epoch, uuid, host, program)
  SELECT id, 1, gen_random_uuid()::text, 'made up', 'relayrig' FROM made RETURNING id";

/// Makes the runs of history `$1` with `$2` parts from the instant `$3` on, a part every `$4` microseconds.
const RUNS: &str = "
INSERT INTO relayrig.run (id, history_id, uuid, lot, number, recipe_hash, opened_at_us, source, written_by)
  SELECT ($1::bigint << 40) + n, $1::bigint, gen_random_uuid()::text, 'L-' || $1::int || '-' || n, 1, 'made-up',
    $3::bigint + (n - 1) * 1000 * $4::bigint, 'simulated', 'relayrig'
  FROM generate_series(1, ($2::bigint + 999) / 1000) AS n";

/// Makes the parts: 4 % fail, 0.5 % are void; half of them land after they were sent.
const PARTS: &str = "
INSERT INTO relayrig.part
  SELECT ($1::bigint << 40) + n, $1::bigint, ($1::bigint << 40) + 1 + (n - 1) / 1000, 'lot', 1 + (n - 1) % 1000,
    'S-' || $1::int || '-' || n, verdict, bin, CASE verdict WHEN 'pass' THEN '[]' ELSE '[\"made_up_1_v high\"]' END,
    $3::bigint + n * $4::bigint, 0.74, 1.69, CASE WHEN n % 2 = 0 THEN bin END,
    CASE WHEN n % 2 = 0 THEN $3::bigint + n * $4::bigint + 400000 END
  FROM (SELECT n, CASE WHEN drawn < 0.04 THEN 'fail' WHEN drawn < 0.045 THEN 'void' ELSE 'pass' END AS verdict,
      CASE WHEN drawn < 0.04 THEN 'voltage' WHEN drawn < 0.045 THEN 'retest' ELSE 'pass' END AS bin
    FROM (SELECT n, random() AS drawn FROM generate_series(1, $2::bigint) AS n) AS drawn) AS judged";

const CHANGES: &str = "
INSERT INTO relayrig.part_change
  SELECT id, id, judged_at_us, verdict, bin, reasons, cycle_s, bin, judged_at_us + 400000 FROM relayrig.part
  WHERE history_id = $1::bigint AND landed_bin IS NULL AND judged_at_us > $3::bigint - $4::bigint + 0 * $2::bigint";

/// Makes 25 measurements of each part, normally distributed.
const MEASUREMENTS: &str = "
INSERT INTO relayrig.measurement
  SELECT part.id, part.run_id, part.judged_at_us, parameter.id, 1,
    7 + 0.3 * sqrt(-2 * ln(1 - random())) * cos(6.283185307179586 * random()), 0.021, NULL, 9, part.verdict, 'lot',
    '{\"gain\":0.006,\"noise\":0.004,\"temperature\":0.003}'
  FROM relayrig.part CROSS JOIN relayrig.parameter
  WHERE part.history_id = $1::bigint AND parameter.key LIKE 'made\\_up\\_%' AND judged_at_us > $3::bigint - $4::bigint + 0 * $2::bigint";

/// Makes the histories; calls `made` with the number of parts after each rig.
///
/// # Errors
/// Fails when the database holds a rig of a real plant, and as a push does.
pub async fn generate(
    target: &FleetTarget,
    wanted: Wanted,
    mut made: impl FnMut(i64),
) -> Result<()> {
    let mut link = Link::open(target).await?;
    let real = "SELECT site FROM relayrig.rig WHERE site <> $1 LIMIT 1";
    if let Some(row) = link.rows(DOING, real, &[&SITE]).await?.first() {
        return Err(FleetError::RealRigs {
            target: link.target.clone(),
            site: row.get(0),
        });
    }
    let unlimited = "SET statement_timeout = 0; SET synchronous_commit = off";
    let name = link.target.clone();
    let doing = |error| FleetError::of(&name, DOING, error);
    link.client.batch_execute(unlimited).await.map_err(doing)?;
    link.client.batch_execute(PARAMETERS).await.map_err(doing)?;
    let until_us = jiff::Timestamp::now().as_microsecond();
    let since_us = until_us - wanted.days * 86_400_000_000;
    let months = "SELECT relayrig.ensure_months($1, $2)";
    link.row(DOING, months, &[&since_us, &until_us]).await?;
    let first: i64 = link
        .row(DOING, "SELECT count(*) FROM relayrig.rig", &[])
        .await?
        .get(0);
    let each = wanted.parts / wanted.rigs;
    let step_us = (until_us - since_us) / (each + 1);
    for n in 1..=wanted.rigs {
        let tx = link.client.transaction().await.map_err(doing)?;
        let rig = format!("rig-{:03}", first + n);
        let history: i32 = tx
            .query_one(RIG, &[&SITE, &rig])
            .await
            .map_err(doing)?
            .get(0);
        for statement in [RUNS, PARTS, CHANGES, MEASUREMENTS] {
            tx.execute(
                statement,
                &[&i64::from(history), &each, &since_us, &step_us],
            )
            .await
            .map_err(doing)?;
        }
        tx.commit().await.map_err(doing)?;
        made(n * each);
    }
    link.client.batch_execute("ANALYZE").await.map_err(doing)
}
