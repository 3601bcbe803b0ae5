CREATE TABLE person (
  name     TEXT PRIMARY KEY,             -- case-sensitive
  role     TEXT NOT NULL CHECK (role IN ('operator', 'maintainer', 'engineer')),
  password TEXT NOT NULL,                -- Argon2id string with salt and parameters
  since_us INTEGER NOT NULL              -- UTC, microseconds
) STRICT, WITHOUT ROWID;

CREATE TABLE session (
  token_sha256 TEXT PRIMARY KEY,         -- of the token, which only its client has
  person       TEXT NOT NULL REFERENCES person (name) ON DELETE CASCADE,
  until_us     INTEGER NOT NULL          -- UTC, microseconds
) STRICT, WITHOUT ROWID;
