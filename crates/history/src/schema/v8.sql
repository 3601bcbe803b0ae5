-- Schema 8: why a part did not pass, as codes that programs compare. part.reasons keeps the texts as they were.
-- A table and not a column of part: a reason is written once and never changed (an interruption adds one), a copy elsewhere
-- can go by its key, and a count by code or parameter takes no JSON apart. Texts of older rows are read once, by the program.

CREATE TABLE reason (
  part_id INTEGER NOT NULL                -- the part that did not pass
    REFERENCES part (id),
  n INTEGER NOT NULL                      -- place in part.reasons, from 1
    CHECK (n >= 1),
  code TEXT NOT NULL                      -- what was found; unclassified: a text that has no code
    CHECK (length(code) BETWEEN 1 AND 100),
  parameter_id INTEGER                    -- the parameter it speaks of, null when it speaks of none
    REFERENCES parameter (id),
  side TEXT                               -- side of the limit, low or high, null when it speaks of none
    CHECK (side IN ('low', 'high')),
  detail TEXT NOT NULL,                   -- figure, pin or cause that the text names, or all of a text without a code
  PRIMARY KEY (part_id, n)
) STRICT, WITHOUT ROWID;
