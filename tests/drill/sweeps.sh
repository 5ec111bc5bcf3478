# A small sweep of each protocol, $work/sweeps/PROTOCOL.cfg, whose digest is the same everywhere. Sourced.
mkdir -p "$work/sweeps"
sweep() { printf 'protocol = "%s"; replicas = 3; seed = 1993;\nfixed = { %s };\n%s\n' "$1" "$2" "$3" >"$work/sweeps/$1.cfg"; }
sweep repose 'W = 2.0; H = 2.0; stop = "steps"; fill_steps = 2500; relax_steps = 1500;' 'grid = { mu = [0.2, 0.3]; };'
sweep stress 'W = 2.0; H = 1.0; fill_steps = 1500; rest_energy = 1e-3; rest_force = 1e3;' 'grid = { mu = [0.2, 0.3]; };'
sweep onset 'W = 2.0; H = 1.0; fill_steps = 1500; rest_energy = 1e-3; rest_force = 1e3;' 'grid = { mu = [0.2, 0.3]; };'
sweep flux 'W = 1.4; insertions = 12;' 'grid = { mu = [0.2, 0.3]; };'
sweep pile 'base = 12; disorder = 1e-4; well = 1.0;' 'grid = { alpha_deg = [30.0, 45.0]; };'
sweep drop 'N = 12; radius_width = 0.05;' 'grid = { mu = [0.3, 0.5]; };'
