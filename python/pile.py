# %% [markdown]
# A pile from Python: simulate a scene, look at its frames, and fit its surface. The cells (# %%) run in
# Jupyter, VS Code or Spyder, and the whole as `python3 python/pile.py [FOLDER]`.

# %%
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import repose

folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp())
folder.mkdir(parents=True, exist_ok=True)

# %% A box of 60 grains; its right wall opens at step 12000. Units are cm, g, s.
scene = folder / "pile.cfg"
scene.write_text("""
gravity = [0.0, -981.0]; dt = 5.0e-5; steps = 30000; x_max = 6.0;
normal = { law = "hertz"; k_n = 1.0e6; gamma_n = 500.0; };
tangential = { law = "spring"; k_s = 1.0e4; mu = 0.4; };
walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; },
          { point = [0.0, 0.0]; direction = [1.0, 0.0]; },
          { point = [1.6, 0.0]; direction = [-1.0, 0.0]; open_at_step = 12000; } );
fill = { N = 60; W = 1.6; H = 6.4; };
""")
frames = repose.run(scene, folder / "pile", every=2000)

# %% How high the grains stand, how fast they move, and how hard they press, frame by frame
print("     t      top  speed  largest normal force")
for frame in frames:
    grains, contacts = frame.grains, frame.contacts
    top = max(y + r for y, r in zip(grains["y"], grains["r"]))
    speed = max((vx * vx + vy * vy) ** 0.5 for vx, vy in zip(grains["vx"], grains["vy"]))
    force = max(contacts["normal_force"], default=0.0)
    print(f"{frame.t:6.3f} {top:8.4f} {speed:6.2f} {force:8.2f}")

# %% The slope of the pile by any command of the program
last = folder / "last.tsv"
with last.open("w") as file:
    print("x\ty\tr", file=file)
    for row in zip(*(frames[-1].grains[name] for name in "xyr")):
        print(*row, sep="\t", file=file)
slopes = repose.command("angle", "slope", last, "--width", 1.6, allowed=(0, 1))
for method, theta in zip(slopes["method"], slopes["theta_deg"]):
    print(f"theta_R by method {method:.0f}: {theta:.1f} degrees")

# %% With pandas: energies against time, drawn if matplotlib is there
try:
    energy = repose.read_table(folder / "pile" / "energy.tsv").dataframe()
    print(energy[["t", "kinetic", "elastic"]].to_string(index=False))
    energy.plot(x="t", y=["kinetic", "elastic"]).figure.savefig(folder / "energy.png")
except ImportError as missing:
    print(f"(skipped: {missing})")
