"""How colours look to the colour-blind, and how far apart they are: for the tests of figures and pages."""

from __future__ import annotations

import numpy as np

# Machado, Oliveira and Fernandes (2009), severity 1, on linear RGB; tritanopia is their least certain one.
VISION = {
    "usual": np.eye(3),
    "protanopia": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
    ),
    "deuteranopia": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
    ),
    "tritanopia": np.array(
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]]
    ),
}
# sRGB (D65) to XYZ
_TO_XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.119192, 0.9503041]]
)


def linear(colour: str) -> np.ndarray:
    """Linear RGB, 0 to 1, of "#rrggbb"."""
    coded = np.frombuffer(bytes.fromhex(colour[1:]), dtype=np.uint8) / 255.0
    return np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)


def seen(colour: str, vision: str) -> np.ndarray:
    """CIELAB (L, a, b) of a colour under a kind of vision."""
    rgb = np.clip(VISION[vision] @ linear(colour), 0.0, 1.0)
    ratio = _TO_XYZ @ rgb / (_TO_XYZ @ np.ones(3))
    f = np.where(ratio > (6 / 29) ** 3, np.cbrt(ratio), ratio / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])])


def difference(first: np.ndarray, second: np.ndarray) -> float:
    """CIEDE2000 between two CIELAB colours (Sharma, Wu and Dalal 2005)."""
    chroma = np.mean([np.hypot(*first[1:]), np.hypot(*second[1:])])
    stretch = 1.0 + 0.5 * (1.0 - np.sqrt(chroma**7 / (chroma**7 + 25.0**7)))
    (l1, a1, b1), (l2, a2, b2) = (first * (1.0, stretch, 1.0), second * (1.0, stretch, 1.0))
    c1, c2 = np.hypot(a1, b1), np.hypot(a2, b2)
    h1, h2 = np.degrees(np.arctan2(b1, a1)) % 360.0, np.degrees(np.arctan2(b2, a2)) % 360.0
    turn = 0.0 if c1 * c2 == 0.0 else (h2 - h1 + 180.0) % 360.0 - 180.0
    dl, dc, dh = l2 - l1, c2 - c1, 2.0 * np.sqrt(c1 * c2) * np.sin(np.radians(turn / 2.0))
    light, c = (l1 + l2) / 2.0, (c1 + c2) / 2.0
    hue = h1 + h2 if c1 * c2 == 0.0 else (h1 + turn / 2.0) % 360.0
    cosine = [np.cos(np.radians(k * hue + shift)) for k, shift in ((1, -30.0), (2, 0.0), (3, 6.0), (4, -63.0))]
    t = 1.0 - 0.17 * cosine[0] + 0.24 * cosine[1] + 0.32 * cosine[2] - 0.20 * cosine[3]
    sl = 1.0 + 0.015 * (light - 50.0) ** 2 / np.sqrt(20.0 + (light - 50.0) ** 2)
    sc, sh = 1.0 + 0.045 * c, 1.0 + 0.015 * c * t
    angle = np.radians(60.0 * np.exp(-(((hue - 275.0) / 25.0) ** 2)))
    rotation = -np.sin(angle) * 2.0 * np.sqrt(c**7 / (c**7 + 25.0**7))
    parts = dl / sl, dc / sc, dh / sh
    return float(np.sqrt(parts[0] ** 2 + parts[1] ** 2 + parts[2] ** 2 + rotation * parts[1] * parts[2]))


def contrast(first: str, second: str) -> float:
    """Contrast ratio of two colours (WCAG 2): 1 for like ones, 21 for black on white."""
    light, dark = sorted((float(_TO_XYZ[1] @ linear(colour)) + 0.05 for colour in (first, second)), reverse=True)
    return light / dark
