"""Shading of cloth and skin that makes folds visible.

Key light with soft shadows, fill, rim and hemispheric ambient light, the latter darkened by
screen-space ambient occlusion.
"""

import math

import numpy as np
from numba import types

from toile.geometry.arrays import Float
from toile.geometry.kernel import F64_1, F64_2, I32_1, I32_2, OUT_F64_3, helper, kernel

F32_2 = types.Array(types.float32, 2, "C", readonly=True)
GOLDEN_ANGLE = 2.399963229728653
CREASE_RADIUS, HOLLOW_RADIUS = 0.022, 0.09
"""Radii of the two occlusion discs [m]: folds, and the hollows between body parts."""


def spiral_disc(samples: int) -> Float:
    """Return points spread evenly over the unit disc, ordered outwards, shape (samples, 2)."""
    radius = np.sqrt((np.arange(samples) + 0.5) / samples)
    angle = GOLDEN_ANGLE * np.arange(samples)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


@helper
def pixel_noise(column, row):  # type: ignore[no-untyped-def]
    """Return a well mixed number in 0..1: interleaved gradient noise (Jimenez 2014)."""
    mixed = 0.06711056 * column + 0.00583715 * row
    mixed = 52.9829189 * (mixed - math.floor(mixed))
    return mixed - math.floor(mixed)


@helper
def open_sky(nearness, row, column, depth, slope_x, slope_y, pixels, radius, disc, cosine, sine):  # type: ignore[no-untyped-def]
    """Return the share of a disc of a radius [m, and in pixels] around a pixel with nothing in front of it.

    nearness: 1 / depth of what each pixel shows. slope: change of depth per pixel in the tangent plane.
    cosine, sine: turn of the disc. What rises more than the radius above the plane is another body part:
    it fades out.
    """
    height, width = nearness.shape
    blocked = 0.0
    for k in range(len(disc)):
        dx = pixels * (cosine * disc[k, 0] - sine * disc[k, 1])
        dy = pixels * (sine * disc[k, 0] + cosine * disc[k, 1])
        x, y = int(column + dx + 0.5), int(row + dy + 0.5)
        if x < 0 or y < 0 or x >= width or y >= height or nearness[y, x] <= 0.0:
            continue
        rise = depth + slope_x * (x - column) + slope_y * (y - row) - 1.0 / nearness[y, x]
        if rise > 0.0:
            across = radius * radius * (disc[k, 0] * disc[k, 0] + disc[k, 1] * disc[k, 1])
            # Sine of the elevation over the tangent plane, less a little for facets.
            elevation = rise / math.sqrt(rise * rise + across) - 0.08
            if elevation > 0.0:
                blocked += elevation / (1.0 + (rise / radius) ** 2)
    return max(0.0, 1.0 - 1.7 * blocked / len(disc))


@helper
def lit_share(shadow, u, v, near, radius, disc, cosine, sine):  # type: ignore[no-untyped-def]
    """Return the share of a disc [pixels] in a shadow map at (u, v) that sees the light.

    near: distance towards the light [pixels]; a surface may rise by as much as the disc's point is away.
    """
    height, width = shadow.shape
    lit = 0
    for k in range(len(disc)):
        dx = radius * (cosine * disc[k, 0] - sine * disc[k, 1])
        dy = radius * (sine * disc[k, 0] + cosine * disc[k, 1])
        x, y = int(u + dx + 0.5), int(v + dy + 0.5)
        away = 1.5 + 1.2 * radius * math.sqrt(disc[k, 0] * disc[k, 0] + disc[k, 1] * disc[k, 1])
        if x < 0 or y < 0 or x >= width or y >= height or shadow[y, x] <= near + away:
            lit += 1
    return lit / len(disc)


@helper
def surface_normal(positions, normals, a, b, c, px, py, pz):  # type: ignore[no-untyped-def]
    """Return the smooth unit normal towards the eye at a point of a face, and 1 if its wrong side shows.

    View space (x right, y up, z depth) is left-handed: the normal built from corners is mirrored.
    """
    ux, uy = positions[b, 0] - positions[a, 0], positions[b, 1] - positions[a, 1]
    uz = positions[b, 2] - positions[a, 2]
    vx, vy = positions[c, 0] - positions[a, 0], positions[c, 1] - positions[a, 1]
    vz = positions[c, 2] - positions[a, 2]
    gx, gy, gz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    square = max(gx * gx + gy * gy + gz * gz, 1e-300)
    wx, wy, wz = px - positions[a, 0], py - positions[a, 1], pz - positions[a, 2]
    wb = ((wy * vz - wz * vy) * gx + (wz * vx - wx * vz) * gy + (wx * vy - wy * vx) * gz) / square
    wc = ((uy * wz - uz * wy) * gx + (uz * wx - ux * wz) * gy + (ux * wy - uy * wx) * gz) / square
    wa = 1.0 - wb - wc
    wrong = gx * px + gy * py + gz * pz < 0.0
    sign = -1.0 if wrong else 1.0
    nx = sign * (wa * normals[a, 0] + wb * normals[b, 0] + wc * normals[c, 0])
    ny = sign * (wa * normals[a, 1] + wb * normals[b, 1] + wc * normals[c, 1])
    nz = sign * (wa * normals[a, 2] + wb * normals[b, 2] + wc * normals[c, 2])
    length = math.sqrt(nx * nx + ny * ny + nz * nz) + 1e-30
    ray = math.sqrt(px * px + py * py + pz * pz)
    # Smooth normals of faces at the silhouette may look away: turn them just enough to be seen.
    away = min(0.0, -(nx * px + ny * py + nz * pz) / (length * ray) - 0.02)
    nx, ny = nx / length + away * px / ray, ny / length + away * py / ray
    nz = nz / length + away * pz / ray
    length = math.sqrt(nx * nx + ny * ny + nz * nz) + 1e-30
    return nx / length, ny / length, nz / length, wrong


@helper
def compressed(light):  # type: ignore[no-untyped-def]
    """Return light with highlights rolled off below 1, so that nothing burns out."""
    return light if light <= 0.7 else 0.7 + 0.3 * math.tanh((light - 0.7) / 0.45)


@kernel(
    types.void(
        F32_2, I32_2, F64_2, F64_2, I32_2, I32_1, F64_2, F32_2, F64_2, F64_1, F64_1, F64_2, F64_2, OUT_F64_3
    )
)
def shade(  # type: ignore[no-untyped-def]
    nearness, face_at, positions, normals, faces, material, colours, shadow, to_shadow, camera, key, disc,
    fine_disc, image,
):  # fmt: skip
    """Write the mean colour of every pixel's samples, and their share that shows a face, into an image.

    nearness, face_at: the depth buffer, samples times larger than the image. positions, normals: of vertices,
    in view space. material: of every face. colours: red, green, blue of the right side and of the wrong side,
    and 1 for cloth, shape (k, 7). shadow: the key light's depth buffer; to_shadow: view space to its columns,
    rows and nearness, shape (3, 4). camera: focal length [samples], centre column, centre row, shadow radius
    [shadow pixels], sine and cosine of the camera's pitch. key: direction to the key light. disc, fine_disc:
    sample points for occlusion and shadow. image: red, green, blue, coverage, shape (height, width, 4).
    """
    height, width, _ = image.shape
    samples = face_at.shape[0] // height
    focal, centre_x, centre_y = camera[0], camera[1], camera[2]
    for index in range(height * width):
        pixel_row, pixel_column = index // width, index % width
        turn = 2.0 * math.pi * pixel_noise(pixel_column, pixel_row)
        cosine, sine = math.cos(turn), math.sin(turn)
        red, green, blue, count = 0.0, 0.0, 0.0, 0
        known_depth, sky, lit = -1.0, 1.0, 1.0
        for sample in range(samples * samples):
            row = pixel_row * samples + sample // samples
            column = pixel_column * samples + sample % samples
            face = face_at[row, column]
            if face < 0:
                continue
            pz = 1.0 / nearness[row, column]
            px, py = (column - centre_x) / focal * pz, (centre_y - row) / focal * pz
            nx, ny, nz, wrong = surface_normal(
                positions, normals, faces[face, 0], faces[face, 1], faces[face, 2], px, py, pz
            )
            # Samples of one pixel on one surface share occlusion and shadow: 4x faster, not visible.
            if abs(pz - known_depth) > 0.01:
                known_depth = pz
                facing = max(-nz, 0.2)
                slope_x, slope_y = nx / facing * pz / focal, -ny / facing * pz / focal
                # One call site: a second one would be inlined and compiled a second time.
                for scale in range(2):
                    radius = HOLLOW_RADIUS if scale else CREASE_RADIUS
                    seen = open_sky(
                        nearness, row, column, pz, slope_x, slope_y, focal * radius / pz, radius,
                        disc, cosine, sine,
                    )  # fmt: skip
                    sky = sky * (0.35 + 0.65 * seen) if scale else seen
                qx, qy, qz = px + 0.003 * nx, py + 0.003 * ny, pz + 0.003 * nz
                u = to_shadow[0, 0] * qx + to_shadow[0, 1] * qy + to_shadow[0, 2] * qz + to_shadow[0, 3]
                v = to_shadow[1, 0] * qx + to_shadow[1, 1] * qy + to_shadow[1, 2] * qz + to_shadow[1, 3]
                near = to_shadow[2, 0] * qx + to_shadow[2, 1] * qy + to_shadow[2, 2] * qz + to_shadow[2, 3]
                lit = lit_share(shadow, u, v, near, camera[3], fine_disc, cosine, sine)
            kind = material[face]
            cloth = colours[kind, 6] > 0.0
            side = 3 if wrong and cloth else 0
            wrap = 0.10 if cloth else 0.22
            toward_key = max(0.0, (nx * key[0] + ny * key[1] + nz * key[2] + wrap) / (1.0 + wrap))
            key_light = toward_key * lit * (0.7 + 0.3 * sky)
            fill = max(0.0, 0.45 + 0.55 * (0.85 * nx + 0.1 * ny - 0.5 * nz)) ** 2
            ambient = 0.55 + 0.45 * (ny * camera[5] - nz * camera[4])
            ray = math.sqrt(px * px + py * py + pz * pz)
            grazing = 1.0 + (nx * px + ny * py + nz * pz) / ray
            rim = max(0.0, grazing) ** 3 * (0.35 + 0.65 * max(0.0, ny)) * (0.3 + 0.7 * sky)
            sheen = (0.14 if cloth else 0.08) * rim
            red += compressed(
                colours[kind, side] * (1.34 * key_light + sky * (0.20 * fill + 0.42 * ambient)) + sheen
            )
            green += compressed(
                colours[kind, side + 1] * (1.27 * key_light + sky * (0.22 * fill + 0.44 * ambient)) + sheen
            )
            blue += compressed(
                colours[kind, side + 2] * (1.16 * key_light + sky * (0.26 * fill + 0.48 * ambient)) + sheen
            )
            count += 1
        total = samples * samples
        image[pixel_row, pixel_column, 0] = red / total
        image[pixel_row, pixel_column, 1] = green / total
        image[pixel_row, pixel_column, 2] = blue / total
        image[pixel_row, pixel_column, 3] = count / total
