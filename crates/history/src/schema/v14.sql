-- Schema 14: plans by which people take tooling off and put it on, with the steps that they have done.

CREATE TABLE tooling_plan (
  id INTEGER PRIMARY KEY,                 -- row number
  started_us INTEGER NOT NULL,            -- when a person started the plan
  who TEXT NOT NULL,                      -- who started it
  role TEXT NOT NULL,                     -- role of that person
  kind TEXT NOT NULL                      -- what the plan is for
    CHECK (kind IN ('changeover', 'disassembly', 'assembly')),
  steps INTEGER NOT NULL                  -- number of steps
    CHECK (steps > 0),
  body TEXT NOT NULL                      -- the whole plan with its drawings, JSON
    CHECK (json_valid(body)),
  under_way INTEGER UNIQUE                -- 1 until the plan ends: a rig has at most one plan under way
    CHECK (under_way = 1),
  ended TEXT                              -- done: every step is done; abandoned: a person gave it up; null while under way
    CHECK (ended IN ('done', 'abandoned')),
  ended_us INTEGER,                       -- when it ended
  ended_by TEXT,                          -- who did the last step or gave the plan up
  why TEXT,                               -- reason for giving it up
  CHECK ((ended IS NULL) = (under_way IS NOT NULL)),
  CHECK ((ended IS NULL) = (ended_us IS NULL))
) STRICT;

CREATE TABLE tooling_step (
  plan_id INTEGER NOT NULL                -- plan of the step
    REFERENCES tooling_plan (id),
  step INTEGER NOT NULL                   -- number of the step, from 1
    CHECK (step > 0),
  done_us INTEGER NOT NULL,               -- when a person ticked it off
  who TEXT NOT NULL,                      -- who ticked it off
  role TEXT NOT NULL,                     -- role of that person
  PRIMARY KEY (plan_id, step)
) STRICT, WITHOUT ROWID;
