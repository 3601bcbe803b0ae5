CREATE TABLE failure (                   -- wrong passwords that still count
  name_sha256 TEXT NOT NULL,             -- of the name as given: people type passwords into the wrong field
  at_us       INTEGER NOT NULL           -- UTC, microseconds
) STRICT;
