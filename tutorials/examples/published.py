"""Published forces of the shallow ironing problem.

The curves were read from the figures of the papers and agree with each other to about 20 %. Kept
here are a few points of each, smoothed over 0.04 of the time; the forces are those on the top of
the die in N per mm of thickness. The time counts 1 for the indentation and 1 for the sliding.

Digitised curves: I. Batistic, solids4foam benchmark "shallowIroning"
(github.com/solids4foam/solid-benchmarks). The test decks of code_aster hold numbers: SSNP153 b with
friction 0.3 and CONT003 a without friction.

>>> vertical, horizontal = PUBLISHED["Yastrebov 2011"]
>>> vertical[TIMES.index(1.5)], horizontal[TIMES.index(1.5)]
(360, 173)
"""

TIMES = (0.4, 0.6, 0.8, 1.0, 1.05, 1.1, 1.25, 1.5, 1.75, 1.9)

# Name -> (vertical, horizontal) at TIMES.
PUBLISHED = {
    # K. A. Fischer, P. Wriggers, Comput. Methods Appl. Mech. Engrg. 195 (2006) 5020-5036
    "Fischer, Wriggers 2006": (
        (52, 122, 205, 297, 342, 363, 368, 365, 358, 342),
        (9, 22, 40, 61, 143, 174, 186, 194, 185, 135),
    ),
    # S. Hartmann, J. Oliver, R. Weyler, J. C. Cante, J. A. Hernandez,
    # Comput. Methods Appl. Mech. Engrg. 198 (2009) 2607-2631
    "Hartmann et al. 2009": (
        (58, 134, 221, 319, 372, 394, 408, 409, 401, 379),
        (9, 25, 44, 66, 143, 148, 156, 158, 154, 131),
    ),
    # V. A. Yastrebov, thesis, Mines ParisTech, 2011
    "Yastrebov 2011": (
        (57, 128, 206, 290, 327, 352, 365, 360, 351, 334),
        (11, 25, 41, 58, 144, 168, 173, 173, 163, 137),
    ),
    # K. Poulios, Y. Renard, Computers & Structures 153 (2015) 75-90
    "Poulios, Renard 2015": (
        (51, 114, 187, 268, 308, 324, 335, 337, 335, 322),
        (9, 22, 37, 55, 102, 99, 100, 102, 100, 90),
    ),
    # code_aster, test SSNP153 (manual V6.03.153)
    "code_aster 2020": (
        (60, 135, 226, 331, 384, 404, 419, 421, 415, 394),
        (11, 27, 47, 70, 139, 138, 141, 145, 140, 119),
    ),
}

# Time -> (vertical, horizontal).
DECK = {1.1: (402.8, 127.0), 1.2: (416.3, 127.6)}
# Time -> vertical, without friction.
DECK_SMOOTH = {0.6: 130.5, 0.8: 220.7, 1.0: 325.3}
