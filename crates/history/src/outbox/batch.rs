//! Rows of a batch. Times are microseconds since 1970 UTC; numbers of parts and runs are the row numbers of the file.

/// Choice of the raw replies that go to a database.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SampleChoice {
    /// No raw replies.
    #[default]
    None,
    /// Raw replies of parts that did not pass.
    Rejects,
    /// All raw replies.
    All,
}

/// Rows that a target stores in one transaction.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Batch {
    /// UUID, the name of the batch.
    pub uuid: String,
    /// Place in the sequence of all batches of the file, from 1.
    pub number: i64,
    /// Number of the last entry of the queue in the batch.
    pub to: i64,
    /// Key and meaning of every parameter of the file, by row number.
    pub parameters: Vec<(i64, String, String)>,
    /// Recipes of `runs`.
    pub recipes: Vec<RecipeRow>,
    /// New runs.
    pub runs: Vec<RunRow>,
    /// New parts, as they are now.
    pub parts: Vec<PartRow>,
    /// Later changes of parts of earlier batches.
    pub changes: Vec<PartChange>,
    /// Reasons of `parts` and `changes`.
    pub reasons: Vec<ReasonRow>,
    /// Measurements of `parts`.
    pub measurements: Vec<MeasurementRow>,
    /// Samples of `parts`.
    pub samples: Vec<SampleRow>,
    /// Curves of `parts`.
    pub curves: Vec<CurveRow>,
    /// Rows of all other tables.
    pub events: Vec<EventRow>,
}

/// A recipe.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecipeRow {
    /// SHA-256 of `body`, hexadecimal.
    pub hash: String,
    /// Name of the recipe.
    pub name: String,
    /// Text of the recipe, TOML.
    pub body: String,
    /// Time of the first use.
    pub first_used_us: i64,
}

/// Facts about a run that are known when it begins.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunRow {
    /// Row number.
    pub id: i64,
    /// UUID of the run.
    pub uuid: String,
    /// Name of the lot.
    pub lot: String,
    /// Number within the lot.
    pub number: i64,
    /// Hash of the recipe.
    pub recipe_hash: String,
    /// Start of the run.
    pub opened_at_us: i64,
    /// `rig`, `simulated` or `import`.
    pub source: String,
    /// Seed of the simulated rig.
    pub seed: Option<String>,
    /// Name and version of the program that wrote the run.
    pub written_by: String,
}

/// Facts about a part that may change after its judgement.
#[derive(Debug, Clone, PartialEq)]
pub struct PartState {
    /// Verdict on the part.
    pub verdict: String,
    /// Bin of the verdict.
    pub bin: Option<String>,
    /// Reasons of the verdict, JSON.
    pub reasons: String,
    /// Time since the previous part left the nest, s.
    pub cycle_s: Option<f64>,
    /// Bin whose beam saw the part.
    pub landed_bin: Option<String>,
    /// Time at which the beam saw the part.
    pub landed_at_us: Option<i64>,
}

/// A part.
#[derive(Debug, Clone, PartialEq)]
pub struct PartRow {
    /// Row number.
    pub id: i64,
    /// Row number of the run.
    pub run: i64,
    /// `lot` or `golden`.
    pub kind: String,
    /// Number of the part in its run.
    pub seq: i64,
    /// Serial number.
    pub serial: Option<String>,
    /// Time of the judgement.
    pub judged_at_us: i64,
    /// Duration of the test, s.
    pub test_s: Option<f64>,
    /// Facts that may change later.
    pub state: PartState,
}

/// A change of a part.
#[derive(Debug, Clone, PartialEq)]
pub struct PartChange {
    /// Entry of the queue.
    pub event: i64,
    /// Row number of the part.
    pub part: i64,
    /// Time of the judgement, by which the target finds the part.
    pub judged_at_us: i64,
    /// State after the change.
    pub state: PartState,
}

/// A reason of a verdict.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReasonRow {
    /// Row number of the part.
    pub part: i64,
    /// Place among the reasons, from 1.
    pub n: i64,
    /// Code of the reason.
    pub code: String,
    /// Row number of the parameter.
    pub parameter: Option<i64>,
    /// Violated limit: `low` or `high`.
    pub side: Option<String>,
    /// Figure, pin or cause.
    pub detail: String,
}

/// A measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasurementRow {
    /// Row number of the part.
    pub part: i64,
    /// Row number of the run.
    pub run: i64,
    /// Time of the part's judgement.
    pub judged_at_us: i64,
    /// Row number of the parameter.
    pub parameter: i64,
    /// Number of the attempt, from 1.
    pub attempt: i64,
    /// Value, in the unit of the parameter.
    pub value: Option<f64>,
    /// Expanded uncertainty, k = 2.
    pub uncertainty: Option<f64>,
    /// Lower limit.
    pub low: Option<f64>,
    /// Upper limit.
    pub high: Option<f64>,
    /// Verdict of the attempt.
    pub verdict: String,
    /// Uncertainty budget, JSON.
    pub budget: Option<String>,
    /// Kind of the part (`lot` or `golden`) on the attempt that statistics use; `None` on any other attempt.
    pub population: Option<String>,
}

/// A raw reply of a module.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SampleRow {
    /// Row number of the part.
    pub part: i64,
    /// Row number of the parameter.
    pub parameter: i64,
    /// Number of the attempt, from 1.
    pub attempt: i64,
    /// Place within the attempt, from 1.
    pub n: i64,
    /// Name of the serial line.
    pub line: String,
    /// Address of the module.
    pub module: String,
    /// Channel of the module.
    pub channel: String,
    /// Text sent.
    pub command: String,
    /// Text received.
    pub raw: String,
    /// Time at which the last byte of the reply arrived.
    pub at_us: i64,
}

/// A sampled curve.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveRow {
    /// Row number of the part.
    pub part: i64,
    /// Name of the point.
    pub signal: String,
    /// Unit of the samples.
    pub unit: String,
    /// Value of one step.
    pub step: f64,
    /// Time of the first sample.
    pub begin_us: i64,
    /// Number of samples.
    pub samples: i64,
    /// Samples, as the file has them.
    pub packed: Vec<u8>,
}

/// A new or changed row of any other table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EventRow {
    /// Entry of the queue.
    pub event: i64,
    /// Name of the table.
    pub kind: String,
    /// Row number in that table; for a fact about a run or a lot, the row number of the run or lot.
    pub row: i64,
    /// Row number of the run, if the row names a run.
    pub run: Option<i64>,
    /// Columns with their values, JSON.
    pub body: String,
}
