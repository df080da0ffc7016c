/** How high all is: shadows straight below, and a dropped line with the height of the payload. */

import { BufferGeometry, Float32BufferAttribute, Group, LineSegments, Mesh, MeshBasicMaterial, NotEqualStencilFunc, ReplaceStencilOp } from 'three';

export class Heights {
  /**
   * @param {import('./formation.js').Formation} formation
   * @param {import('./obstacles.js').Obstacles} obstacles
   * @param {import('./palette.js').Palette} palette
   * @param {import('./labels.js').Labels} labels
   */
  constructor(formation, obstacles, palette, labels) {
    this.group = new Group();
    this.formation = formation;
    // Each point of the ground is darkened once, however many bodies are above it.
    const dark = new MeshBasicMaterial({
      color: 0x000000, transparent: true, opacity: 0.28, depthWrite: false,
      stencilWrite: true, stencilRef: 1, stencilFunc: NotEqualStencilFunc, stencilZPass: ReplaceStencilOp,
    });
    palette.materials.push({ colour: null, material: dark });
    palette.onChange(() => {
      dark.opacity = palette.scheme.matches ? 0.6 : 0.28;
    });
    const flat = new Group();
    flat.scale.y = 1e-4;
    flat.position.y = 0.004;
    this.group.add(flat);
    /** @type {{body: import('three').Object3D, shadow: import('three').Object3D}[]} */
    this.shadows = [];
    const bodies = [formation.payload, ...formation.uavs.map(({ mesh }) => mesh), ...formation.links, ...obstacles.obstacles.map(({ mesh }) => mesh)];
    for (const body of bodies) {
      const shadow = body.clone();
      const lines = [];
      shadow.traverse((part) => {
        if (part instanceof Mesh) {
          part.material = dark;
          part.renderOrder = -1;
        } else if (part instanceof LineSegments || 'isLine' in part) lines.push(part);
      });
      for (const line of lines) line.removeFromParent();
      flat.add(shadow);
      this.shadows.push({ body, shadow });
    }
    this.bodies = [formation.payload, ...obstacles.obstacles.map(({ mesh }) => mesh)];
    this.drops = new LineSegments(
      new BufferGeometry().setAttribute('position', new Float32BufferAttribute(new Float32Array(6 * this.bodies.length), 3)),
      palette.hairline('muted', 0.8),
    );
    this.drops.frustumCulled = false;
    this.group.add(this.drops);
    this.label = labels.add('', 'height');
  }

  update() {
    for (const { body, shadow } of this.shadows) {
      shadow.position.copy(body.position);
      shadow.quaternion.copy(body.quaternion);
      shadow.scale.copy(body.scale);
    }
    const ends = this.drops.geometry.getAttribute('position');
    this.bodies.forEach(({ position: { x, y, z } }, i) => {
      ends.setXYZ(2 * i, x, Math.max(y, 0), z);
      ends.setXYZ(2 * i + 1, x, 0, z);
    });
    ends.needsUpdate = true;
    const { x, y, z } = this.formation.payload.position;
    this.label.position.set(x, y - Math.min(y / 2, 1.5), z);
    this.label.say(`${y.toFixed(1)} m up`);
    this.label.visible = y > 1 && this.group.visible;
  }
}
