#!/usr/bin/env python3
"""Renders a picture from a results folder, off screen.

    pip install pyvista pillow
    python assets/render.py out --field von_mises --label "von Mises stress [MPa]" --output punch.png

Bodies are warped by their displacement and coloured by a field of the nodes; rigid surfaces are drawn half transparent
from their tessellated copies, with the borders of their patches. Without a field bodies are plain grey.
"""
import argparse
import sys
from pathlib import Path

import numpy as np
import pyvista as pv
from PIL import Image

AXES = "xyz"
# Directions from which the camera looks at the model: azimuth from the x axis towards y, elevation (degrees).
VIEWS = {
    "iso": (-55, 25),
    "low": (-55, 10),
    "high": (-55, 45),
    "front": (-90, 0),
    "side": (0, 0),
    "top": (-90, 89.9),
}
# Values 0 to 3 of `contact_status`, and their colours.
STATUS = {"no slave": "#8d97a3", "open": "#b8c4d2", "stick": "#2b6cb0", "slip": "#e8891c"}
# Components of a symmetric tensor, as the result files name them.
TENSOR = ["XX", "YY", "ZZ", "XY", "YZ", "XZ"]


def arguments():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("folder", type=Path, help="results folder, with results_tessellated.pvd")
    p.add_argument("--output", type=Path, default=Path("picture.png"))
    p.add_argument("--field", help="point data to colour by; displacement and vectors: magnitude unless --component")
    p.add_argument("--component", help="x, y, z of a vector; XX ... XZ of a tensor")
    p.add_argument("--label", help="title of the colour bar, with the unit; default: the field's name")
    p.add_argument("--range", type=float, nargs=2, metavar=("LOW", "HIGH"), help="of the colours")
    p.add_argument("--cmap", default="viridis", help="colour map")
    p.add_argument("--time", type=float, help="the last time not after this one; default: the last")
    p.add_argument("--warp", type=float, default=1.0, help="factor on the displacement")
    p.add_argument("--parts", nargs="*", help="draw only parts of these names")
    p.add_argument("--mirror", default="", help="xy: mirror the bodies over x = 0 and y = 0")
    p.add_argument("--mirror-surfaces", default="", help="the same for rigid surfaces that are modelled in part")
    p.add_argument("--clip", nargs="*", default=[], metavar="SIDE",
                   help="cut rigid surfaces open: +y keeps y >= 0, x<3 and z>1.5 keep what they say")
    p.add_argument("--clip-bodies", nargs="*", default=[], metavar="SIDE", help="the same for bodies, after mirroring")
    p.add_argument("--camera", default="iso",
                   help=f"{', '.join(VIEWS)}, or AZIMUTH,ELEVATION in degrees")
    p.add_argument("--zoom", type=float, default=1.0)
    p.add_argument("--fit", choices=["bodies", "all"], default="bodies", help="what the picture is centred on")
    p.add_argument("--opacity", type=float, default=0.35, help="of rigid surfaces; 0 leaves them out")
    p.add_argument("--behind", type=float, default=3e-3,
                   help="part of the model's size by which bodies lie behind rigid surfaces that they touch")
    p.add_argument("--no-edges", action="store_true", help="leave out the element edges")
    p.add_argument("--palette", type=int, metavar="COLOURS", help="at most this many colours (up to 256): smaller files")
    p.add_argument("--size", type=int, nargs=2, default=[1400, 900], metavar=("WIDTH", "HEIGHT"))
    return p.parse_args()


def read_step(folder, time):
    """The parts at one time: [(name, grid)], and the time."""
    import xml.etree.ElementTree as ET

    pvd = folder / "results_tessellated.pvd"
    if not pvd.exists():
        sys.exit(f"{pvd} does not exist")
    entries = [(float(d.get("timestep")), d.get("name"), d.get("file")) for d in ET.parse(pvd).iter("DataSet")]
    times = sorted({e[0] for e in entries})
    if time is not None:
        times = [t for t in times if t <= time * (1 + 1e-12)]
    if not times:
        sys.exit(f"{pvd} has no step" + ("" if time is None else f" up to time {time}"))
    return [(name, pv.read(folder / file)) for t, name, file in entries if t == times[-1]], times[-1]


def colours(grid, field, component):
    """The field as one number per node, and whether mirroring over x, y, z turns its sign."""
    data = grid.point_data[field]
    if data.ndim == 1:
        return data, [1, 1, 1]
    names = list(AXES) if data.shape[1] == 3 else TENSOR if data.shape[1] == 6 else []
    if component is None:
        if data.shape[1] == 3:
            return np.linalg.norm(data, axis=1), [1, 1, 1]
        sys.exit(f"{field} has {data.shape[1]} components: choose one by --component {names}")
    lookup = {n.lower(): i for i, n in enumerate(names)}
    if component.lower() not in lookup:
        sys.exit(f"{field} has the components {names}, not {component}")
    signs = [(-1) ** component.lower().count(a) for a in AXES]
    return data[:, lookup[component.lower()]], signs


def element_status(grid):
    """`contact_status` of each element: what most of its touching nodes do, else whether any is a slave."""
    status = np.rint(grid.point_data["contact_status"]).astype(int)
    cells, ends = grid.cell_connectivity, grid.offset
    values = np.zeros(grid.n_cells)
    for e in range(grid.n_cells):
        own = status[cells[ends[e]:ends[e + 1]]]
        touching = own[own >= 2]
        values[e] = np.rint(touching.mean() + 1e-9) if touching.size else own.max()
    return values


def mirrored(grid, axes, signs):
    """The grid with its mirror images over the planes through the origin."""
    images = [grid]
    for axis in axes:
        k = AXES.index(axis)
        for image in list(images):
            copy = image.copy()
            points = np.array(copy.points)
            points[:, k] *= -1
            copy.points = points
            if "colour" in copy.point_data:
                copy.point_data["colour"] = signs[k] * np.array(copy.point_data["colour"])
            if "normal" in copy.point_data:
                normals = np.array(copy.point_data["normal"])
                normals[:, k] *= -1
                copy.point_data["normal"] = normals
            images.append(copy)
    return images


def clipped(grid, sides):
    for side in sides:
        try:
            if side[0] in "+-" and side[1:] in AXES:
                axis, keep_above, at = side[1:], side[0] == "+", 0.0
            else:
                axis, keep_above, at = side[0], {">": True, "<": False}[side[1]], float(side[2:])
                AXES.index(axis)
        except (KeyError, ValueError, IndexError):
            sys.exit(f"--clip {side}: write +y, -x, x<3 or z>1.5")
        origin = [at if a == axis else 0.0 for a in AXES]
        grid = grid.clip(normal=axis, origin=origin, invert=not keep_above)
    return grid


def add_body(plotter, grid, args, style):
    grid = grid.copy()
    signs = [1, 1, 1]
    if args.field == "contact_status" and args.field in grid.point_data:
        # Between nodes there are no states in between.
        grid.cell_data["colour"] = element_status(grid)
    elif args.field and args.field in grid.point_data:
        grid.point_data["colour"], signs = colours(grid, args.field, args.component)
    grid.points = grid.points + args.warp * grid.point_data["displacement"]
    bounds = []
    for image in mirrored(grid, args.mirror, signs):
        shown = clipped(image, args.clip_bodies)
        if shown.n_cells == 0:
            continue
        surface = shown.extract_surface(algorithm="dataset_surface")
        bounds.append(surface.bounds)
        look = style if "colour" in surface.array_names else {"color": "lightsteelblue"}
        plotter.add_mesh(surface, show_edges=not args.no_edges, edge_color="#404040", line_width=1.6,
                         edge_opacity=0.45, ambient=0.25, diffuse=0.75, specular=0.1, **look)
        outline = surface.extract_feature_edges(feature_angle=50, manifold_edges=False, non_manifold_edges=False)
        for axis in args.mirror:
            # No line where the model meets its image.
            if outline.n_cells:
                away = np.abs(outline.cell_centers().points[:, AXES.index(axis)]) > 1e-6 * surface.length
                outline = outline.extract_cells(away)
        if outline.n_cells:
            plotter.add_mesh(outline, color="#303030", line_width=3.5)
    return bounds


def moved(grid):
    """A surface where its displacement leads."""
    if "displacement" not in grid.point_data:
        return grid
    grid = grid.copy()
    grid.points = grid.points + grid.point_data["displacement"]
    return grid


def add_surface(plotter, grid, args):
    images = [clipped(image, args.clip) for image in mirrored(grid, args.mirror_surfaces, [1, 1, 1])]
    return [draw_surface(plotter, image, args) for image in images if image.n_cells > 0]


def draw_surface(plotter, grid, args):
    surface = grid.extract_surface(algorithm="dataset_surface")
    surface.point_data.active_normals_name = "normal"
    plotter.add_mesh(surface, color="#8a93a0", opacity=args.opacity, smooth_shading=True, specular=0.5,
                     specular_power=20, ambient=0.2)
    for patch in np.unique(surface.cell_data["patch"]):
        part = surface.extract_cells(surface.cell_data["patch"] == patch).extract_surface(algorithm="dataset_surface")
        border = part.clean(tolerance=1e-7).extract_feature_edges(
            boundary_edges=True, feature_edges=False, manifold_edges=False, non_manifold_edges=False)
        if border.n_cells:
            plotter.add_mesh(border, color="#4a525e", line_width=4, opacity=min(1.0, 2 * args.opacity))
    return surface.bounds


def place_camera(plotter, args, bounds):
    if args.camera in VIEWS:
        azimuth, elevation = np.radians(VIEWS[args.camera])
    else:
        try:
            azimuth, elevation = np.radians([float(x) for x in args.camera.split(",")])
        except ValueError:
            sys.exit(f"--camera {args.camera}: one of {', '.join(VIEWS)}, or AZIMUTH,ELEVATION")
    b = np.array(bounds)
    low, high = b[:, ::2].min(axis=0), b[:, 1::2].max(axis=0)
    centre = (low + high) / 2
    away = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
    camera = plotter.camera
    camera.focal_point = centre
    camera.position = centre + away * np.linalg.norm(high - low)
    camera.up = (0, 0, 1)
    camera.view_angle = 25
    plotter.reset_camera(bounds=[low[0], high[0], low[1], high[1], low[2], high[2]])
    camera.zoom(1.2 * args.zoom)
    if args.field:
        # Room for the colour bar.
        camera.SetWindowCenter(0.1, 0.0)
    # Everything may be nearer or farther than what the picture is centred on.
    plotter.renderer.ResetCameraClippingRange()


def with_palette(image, colours, cmap):
    """The picture with so many colours: those of the background and the colour bar, the rest spread over what occurs."""
    pixels = np.asarray(image)
    background = pixels[np.linspace(0, len(pixels) - 1, colours // 8).astype(int), 0]
    bar = [np.array(pv.LookupTable(cmap, n_values=colours // 4).values)[:, :3]] if cmap else []
    kept = np.unique(np.concatenate([background, *bar]), axis=0)
    occur = np.unique(pixels.reshape(-1, 3), axis=0)
    rest = Image.fromarray(occur[None]).quantize(colours - len(kept)).convert("RGB")
    both = np.concatenate([kept, np.unique(np.asarray(rest).reshape(-1, 3), axis=0)])
    palette = Image.new("P", (1, 1))
    palette.putpalette(both.astype(np.uint8).tobytes())
    return image.quantize(palette=palette, dither=Image.Dither.NONE)


def main():
    args = arguments()
    parts, time = read_step(args.folder, args.time)
    names = sorted({name for name, _ in parts})
    for name in args.parts or []:
        if name not in names:
            sys.exit(f"no part {name}; there are: {', '.join(names)}")
    parts = [(name, grid) for name, grid in parts if not args.parts or name in args.parts]
    bodies = [grid for _, grid in parts if "element" in grid.cell_data]
    # Mid-surfaces lie within their bodies.
    inside = {"element", "sheet_element"}
    surfaces = [moved(grid) for _, grid in parts if not inside & set(grid.cell_data.keys())]

    style = {}
    if args.field:
        coloured = [g for g in bodies if args.field in g.point_data]
        if not coloured:
            fields = sorted({f for g in bodies for f in g.point_data.keys()})
            sys.exit(f"no body has the field {args.field}; there are: {', '.join(fields)}")
        low, high = np.inf, -np.inf
        for grid in coloured:
            values, signs = colours(grid, args.field, args.component)
            low, high = min(low, np.nanmin(values)), max(high, np.nanmax(values))
            if any(signs[AXES.index(a)] < 0 for a in args.mirror):
                low, high = min(low, -high), max(high, -low)
        # A scale that all but begins or ends at zero does.
        low, high = (0.0 if abs(x) < 1e-3 * (high - low) else x for x in (low, high))
        bar = {"title": (args.label or args.field) + "\n", "vertical": True, "position_x": 0.88, "position_y": 0.2,
               "height": 0.6, "width": 0.05, "title_font_size": 44, "label_font_size": 38, "color": "black",
               "fmt": "%.4g", "n_labels": 6}
        style = {"scalars": "colour", "clim": args.range or [low, high], "cmap": args.cmap, "scalar_bar_args": bar,
                 "nan_color": "lightgrey"}
        if args.field == "contact_status":
            # Names in place of numbers; see `main` for the legend.
            style |= {"cmap": list(STATUS.values()), "clim": [-0.5, 3.5], "n_colors": len(STATUS),
                      "show_scalar_bar": False}

    plotter = pv.Plotter(off_screen=True, window_size=[2 * n for n in args.size])
    plotter.set_background("white", top="#e8eef5")
    # Transparent surfaces in the right order need depth peeling, which fails with multisampling: smooth edges come from
    # averaging a picture of twice the size.
    plotter.enable_depth_peeling(20, 0.0)
    plotter.render_window.SetMultiSamples(0)
    plotter.render_window.SetAlphaBitPlanes(1)
    body_bounds = [b for grid in bodies for b in add_body(plotter, grid, args, style)]
    body_actors = [a for a in plotter.actors.values() if isinstance(a, pv.Actor)]
    surface_bounds = [b for grid in surfaces for b in add_surface(plotter, grid, args)] if args.opacity > 0 else []
    if args.field == "contact_status":
        plotter.add_legend([list(entry) for entry in reversed(STATUS.items())], bcolor=None, face="rectangle",
                           size=(0.16, 0.24), loc="upper right")
    wanted = body_bounds if args.fit == "bodies" and body_bounds else body_bounds + surface_bounds
    if not wanted:
        sys.exit("nothing to draw")
    place_camera(plotter, args, wanted)
    # Bodies lie a little behind rigid surfaces that they touch: where both coincide, they would take turns from pixel to pixel.
    low, high = np.min(wanted, axis=0)[::2], np.max(wanted, axis=0)[1::2]
    behind = np.array(plotter.camera.direction) * args.behind * np.linalg.norm(high - low)
    for actor in body_actors:
        actor.position = behind
    args.output.parent.mkdir(parents=True, exist_ok=True)
    image = plotter.screenshot(return_img=True)[:, :, :3].astype(float)
    height, width = image.shape[0] // 2, image.shape[1] // 2
    image = image[: 2 * height, : 2 * width].reshape(height, 2, width, 2, 3).mean(axis=(1, 3))
    image = Image.fromarray(np.rint(image).astype(np.uint8))
    if args.palette:
        image = with_palette(image, args.palette, args.cmap if args.field else None)
    image.save(args.output, optimize=True)
    print(f"{args.output}: time {time:g}")


if __name__ == "__main__":
    main()
