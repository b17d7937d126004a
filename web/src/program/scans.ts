// The files that are taken for points, by their names: those that the program reads as clouds.
const scans = /\.(ply|xyz|pts|csv|pwn|obj|off|las|laz|pcd|ptx|e57|stl|txt|asc)$/i;

export const isScan = (path: string): boolean => scans.test(path);
