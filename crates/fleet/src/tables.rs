//! Lets statements that were written for a history file run on the database: each table that a statement names is
//! defined before it as a common table expression.
//!
//! So a question is written once, for the tables of the file. The database needs no further views, and a read-only
//! replica answers too.

/// Which rigs answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Scope {
    /// All rigs.
    All,
    /// The histories with these numbers.
    Histories(Vec<i32>),
}

/// Where the rows of a table come from.
enum Rows {
    /// The same for all rigs.
    Common(&'static str),
    /// A statement that ends with its conditions, the column with the number of the history, and the grouping.
    OfRigs(&'static str, &'static str, &'static str),
    /// For each row of the file, its last event of the kind that has the name of the table; the text lists the columns.
    Events(&'static str),
}

use Rows::{Common, Events, OfRigs};

/// The parts as they are now. Few parts get another verdict after they were sent, so a join finds these; a subquery
/// finds any other change, and runs only for a question that needs it.
const PARTS: &str = "SELECT it.id, it.history_id, it.run_id, it.kind, it.seq, it.serial, it.judged_at_us, it.test_s,
      coalesce(other.verdict, it.verdict) AS verdict,
      CASE WHEN other.event IS NULL THEN it.bin ELSE other.bin END AS bin,
      coalesce(other.reasons, it.reasons) AS reasons,
      coalesce((SELECT cycle_s FROM relayrig.part_change AS c WHERE c.part_id = it.id ORDER BY event DESC LIMIT 1),
        it.cycle_s) AS cycle_s,
      coalesce((SELECT landed_bin FROM relayrig.part_change AS c WHERE c.part_id = it.id ORDER BY event DESC LIMIT 1),
        it.landed_bin) AS landed_bin,
      coalesce((SELECT landed_at_us FROM relayrig.part_change AS c WHERE c.part_id = it.id ORDER BY event DESC LIMIT 1),
        it.landed_at_us) AS landed_at_us
    FROM relayrig.part AS it LEFT JOIN relayrig.part_rejudged AS other ON other.part_id = it.id AND NOT EXISTS (SELECT 1
      FROM relayrig.part_rejudged AS later WHERE later.part_id = other.part_id AND later.event > other.event)
    WHERE true";

/// Every table of the file that questions name. Lots of several rigs with one name count as one lot.
const TABLES: [(&str, Rows); 18] = [
    ("parameter", Common("SELECT id, key, meaning FROM relayrig.parameter")),
    ("recipe", Common("SELECT hash AS id, hash, name, body, first_used_us FROM relayrig.recipe")),
    ("lot", OfRigs("SELECT lot AS id, lot AS name, min(opened_at_us) AS first_opened_us FROM relayrig.run WHERE true",
        "history_id", " GROUP BY lot")),
    ("run", OfRigs("SELECT it.id, it.uuid, it.lot AS lot_id, it.number, it.recipe_hash AS recipe_id, it.opened_at_us,
          it.source, it.seed, it.written_by, (SELECT site || '/' || rig FROM relayrig.history JOIN relayrig.rig
            ON rig.id = history.rig_id WHERE history.id = it.history_id) AS rig,
          (SELECT (body ->> 'closed_at_us')::bigint FROM relayrig.event WHERE kind = 'run_state' AND row_id = it.id
            ORDER BY id DESC LIMIT 1) AS closed_at_us,
          (SELECT body ->> 'calibration_hash' FROM relayrig.event WHERE kind = 'run_state' AND row_id = it.id
            ORDER BY id DESC LIMIT 1) AS calibration_hash
        FROM relayrig.run AS it WHERE true", "it.history_id", "")),
    ("part", OfRigs(PARTS, "it.history_id", "")),
    ("measurement", OfRigs("SELECT * FROM relayrig.measurement WHERE true", "(run_id >> 40)", "")),
    ("sample", OfRigs("SELECT * FROM relayrig.sample WHERE true", "(part_id >> 40)", "")),
    ("reason", OfRigs("SELECT * FROM relayrig.reason WHERE true", "(part_id >> 40)", "")),
    ("curve", OfRigs("SELECT * FROM relayrig.curve WHERE true", "(part_id >> 40)", "")),
    ("run_end", Events("row_id AS run_id, body ->> 'ended' AS ended, body ->> 'cause' AS cause,
        body ->> 'cause_text' AS cause_text")),
    ("retest", Events("row_id AS run_id, body ->> 'consented_by' AS consented_by")),
    ("alarm", Events("row_id AS id, run_id, body ->> 'code' AS code, body ->> 'line' AS line, body ->> 'text' AS text,
        (body ->> 'raised_at_us')::bigint AS raised_at_us, (body ->> 'cleared_at_us')::bigint AS cleared_at_us,
        nullif(body -> 'args', 'null') AS args")),
    ("alarm_state", Events("row_id AS alarm_id, (body ->> 'acknowledged_at_us')::bigint AS acknowledged_at_us,
        body ->> 'acknowledged_by' AS acknowledged_by, (body ->> 'shelved_until_us')::bigint AS shelved_until_us,
        body ->> 'shelved_by' AS shelved_by, body ->> 'shelf_reason' AS shelf_reason")),
    ("lot_state", Events("body ->> 'lot' AS lot_id, body ->> 'state' AS state, body ->> 'why' AS why,
        nullif(body -> 'alarm', 'null') AS alarm, (body ->> 'since_us')::bigint AS since_us")),
    ("golden_check", Events("row_id AS id, run_id, (body ->> 'at_us')::bigint AS at_us,
        (body ->> 'passed')::integer = 1 AS passed, body ->> 'text' AS text, nullif(body -> 'alarm', 'null') AS alarm,
        (body ->> 'suspect_since_us')::bigint AS suspect_since_us")),
    ("ordered", Events("row_id AS id, run_id, (body ->> 'at_us')::bigint AS at_us, body ->> 'who' AS who,
        body ->> 'role' AS role, body ->> 'origin' AS origin, body -> 'what' AS what, body ->> 'refused' AS refused,
        nullif(body -> 'refusal', 'null') AS refusal")),
    ("reopening", Events("row_id AS id, body ->> 'lot' AS lot_id, (body ->> 'at_us')::bigint AS at_us,
        body ->> 'who' AS who, body ->> 'why' AS why")),
    ("external_result", Events("row_id AS id, body ->> 'lot' AS lot_id, body ->> 'serial' AS serial,
        (body ->> 'run')::bigint AS run, (body ->> 'seq')::bigint AS seq, body ->> 'key' AS key,
        (body ->> 'value')::double precision AS value, (body ->> 'uncertainty')::double precision AS uncertainty,
        (body ->> 'low')::double precision AS low, (body ->> 'high')::double precision AS high,
        body ->> 'verdict' AS verdict, body ->> 'recipe_hash' AS recipe_hash, body ->> 'who' AS who,
        (body ->> 'measured_at_us')::bigint AS measured_at_us, (body ->> 'entered_at_us')::bigint AS entered_at_us,
        body ->> 'file_hash' AS file_hash, (body ->> 'line')::bigint AS line")),
];

/// Clauses of SQLite that PostgreSQL does not know, each with its replacement.
const WORDS: [(&str, &str); 1] = [(" INDEXED BY part_time", "")];

/// Translates a statement on the tables of a file to the SQL of the database: defines each table that the statement
/// names, with the rows of the rigs in `scope`.
pub(crate) fn translated(sql: &str, scope: &Scope) -> String {
    let sql = WORDS
        .iter()
        .fold(sql.to_owned(), |sql, (from, to)| sql.replace(from, to));
    let named = named(&sql);
    let tables = TABLES.iter().filter(|(name, _)| named.contains(name));
    let tables: Vec<String> = tables
        .map(|(name, rows)| expression(name, rows, scope))
        .collect();
    assert!(!tables.is_empty(), "a question to no table: {sql}");
    format!("WITH {}\n{}", tables.join(",\n"), numbered(&sql))
}

/// Returns the words after FROM and JOIN.
fn named(sql: &str) -> Vec<&str> {
    let words = sql.split(|it: char| !it.is_ascii_alphanumeric() && it != '_');
    let words: Vec<&str> = words.filter(|it| !it.is_empty()).collect();
    let after = |two: &[&str]| matches!(two[0], "FROM" | "JOIN");
    words
        .windows(2)
        .filter(|two| after(two))
        .map(|two| two[1])
        .collect()
}

fn expression(name: &str, rows: &Rows, scope: &Scope) -> String {
    let of_rigs = |column: &str| match scope {
        Scope::All => String::new(),
        Scope::Histories(ids) => {
            let ids: Vec<String> = ids.iter().map(i32::to_string).collect();
            format!(" AND {column} IN ({})", ids.join(", "))
        }
    };
    let select = match rows {
        Common(select) => (*select).to_owned(),
        OfRigs(select, history, grouping) => format!("{select}{}{grouping}", of_rigs(history)),
        Events(columns) => format!(
            "SELECT {columns} FROM relayrig.event AS it WHERE it.kind = '{name}'{} AND NOT EXISTS (SELECT 1
             FROM relayrig.event AS later WHERE later.kind = it.kind AND later.row_id = it.row_id AND later.id > it.id)",
            of_rigs("it.history_id")
        ),
    };
    format!("{name} AS NOT MATERIALIZED ({select})")
}

/// Writes parameters as the database does: `?` becomes the next `$n`, `?2` becomes `$2`.
fn numbered(sql: &str) -> String {
    let mut pieces = sql.split('?');
    let mut text = pieces.next().unwrap_or_default().to_owned();
    for (n, piece) in (1..).zip(pieces) {
        text.push('$');
        if !piece.starts_with(|it: char| it.is_ascii_digit()) {
            text.push_str(&format!("{n}"));
        }
        text.push_str(piece);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_question_gets_the_tables_that_it_names() {
        let sql = "SELECT verdict, count(*) FROM part INDEXED BY part_time WHERE judged_at_us >= ?1 AND judged_at_us < ?2
            AND run_id IN (SELECT run.id FROM run JOIN lot ON lot.id = run.lot_id) GROUP BY verdict";
        let text = translated(sql, &Scope::Histories(vec![3, 8]));
        let tables = text.matches(" AS NOT MATERIALIZED (").count();
        assert_eq!(tables, 3, "{text}");
        assert!(
            text.contains("judged_at_us >= $1 AND judged_at_us < $2"),
            "{text}"
        );
        assert!(
            text.contains("history_id IN (3, 8)") && !text.contains("INDEXED"),
            "{text}"
        );
    }

    #[test]
    fn parameters_without_a_number_are_counted() {
        assert_eq!(numbered("a = ? AND b = ?"), "a = $1 AND b = $2");
        assert_eq!(numbered("a = ?2 OR b = ?1"), "a = $2 OR b = $1");
    }
}
