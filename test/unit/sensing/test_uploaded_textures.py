"""Textures of decoded pictures end with them."""
from __future__ import annotations

import os

from PIL import Image

from my_simulations.sensing.camera.uploaded_textures import Textures
from my_simulations.sensing.surfaces import Surface


class Texture:
    def __init__(self, pixels):
        self.pixels, self.released = pixels, False

    def build_mipmaps(self):
        pass

    def release(self):
        self.released = True


class Context:
    """Of moderngl, without a card."""

    LINEAR = LINEAR_MIPMAP_LINEAR = 0

    def __init__(self):
        self.made = []

    def texture(self, size, components, data, internal_format):
        self.made.append(Texture(data))
        return self.made[-1]


def test_a_file_is_read_again_where_it_changed_and_the_former_texture_released(tmp_path):
    context = Context()
    textures = Textures(context, lambda text: None)
    surface, shown = Surface(picture=str(tmp_path / "a.png")), []
    for n, red in enumerate((1, 2, 2)):
        Image.new("RGB", (2, 2), (red, 0, 0)).save(surface.picture)
        os.utime(surface.picture, (red, red))
        textures.renew(surface)
        shown.append(textures.of(surface).pixels[0])
    assert shown == [1, 2, 2]
    assert [texture.released for texture in context.made] == [True, False]


def test_a_picture_at_the_address_of_a_former_one_is_uploaded_and_the_former_released():
    context = Context()
    textures = Textures(context, lambda text: None)
    for n in range(50):
        surface = Surface(picture=Image.new("RGB", (2, 2), (n, 0, 0)))
        assert textures.of(surface).pixels[0] == n
        assert textures.of(surface) is textures.of(surface)
        del surface
    assert len(context.made) == 50
    assert sum(not texture.released for texture in context.made) <= 1
