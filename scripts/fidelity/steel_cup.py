"""The steel cup that both composed scenes put on their table."""
import asset_tools

RADIUS, HEIGHT, WALL = 0.035, 0.08, 0.002  # [m]


def mesh():
    inner = RADIUS - WALL
    profile = [(0, 0.001), (RADIUS - 0.003, 0), (RADIUS, 0.003), (RADIUS, HEIGHT), (inner, HEIGHT),
               (inner, WALL + 0.004), (inner - 0.004, WALL), (0, WALL)]
    return asset_tools.turned(profile, 96)
