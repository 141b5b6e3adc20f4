// Colours of what is drawn in the scene, on either ground; the legend has the same in base.css.

export const COLOURS = {
  measured: 0x7d93b5,
  reference: 0xe09a2c,
  goal: 0x2fa866,
  refused: 0xd8433f,
  force: 0xd8433f,
  contact: 0xb0479c,
  behind: 0x2f7de1,
  region: 0xc25a2e,
};
