-- Schema 7: parts inside of the machine, for the run that comes after one that was killed.

CREATE TABLE inside (
  source TEXT PRIMARY KEY                 -- rig or simulated
    CHECK (source IN ('rig', 'simulated')),
  pocket INTEGER NOT NULL                 -- 1: the pocket held a part
    CHECK (pocket IN (0, 1)),
  nest INTEGER NOT NULL                   -- 1: the nest held a part
    CHECK (nest IN (0, 1)),
  gripper INTEGER NOT NULL                -- 1: the gripper held a part
    CHECK (gripper IN (0, 1)),
  falling TEXT                            -- bin over which a part was let go that no beam had confirmed; null: none
) STRICT, WITHOUT ROWID;
